# Each allocation, write, fsync, rename, open, read, change of a folder and start of a thread of the whole chain fails, as in
# SQLite's tests: one call in turn, by a library in between (fail_once.cpp). After each: a documented exit code and one message
# that says what failed, nothing half under a final name; then the same command ends with the same digits.
# POINTS of them (default 16), spread evenly over kinds, steps and calls; where there are enough, one at each place that calls,
# told apart by its callers; not memory under HDF5 1.10, which then writes where it may not. At one point in six all later
# calls fail, too. STEPS and KINDS: only these; FIRST: from that one on, so that a long campaign is made in pieces.
. "$GRAINLAW_SOURCE_DIR/tests/survival/chain_scene.bash"
library=$GRAINLAW_BUILD_DIR/tests/libfail_once.so
[[ -e $library ]] || { echo "no $library in this build: skipped" >&2; exit 77; }
points=${POINTS:-16}
read -ra steps <<<"${STEPS:-${steps[*]}}"
kinds=${KINDS:-alloc write fsync rename open read folder thread}
declare -A reasons=([alloc]=12 [write]="28 5" [fsync]="5 28" [rename]="5 28" [open]="24 28" [read]=5 [folder]="28 5" [thread]=11)
declare -A words=([12]="memory" [28]="No space left on device" [5]="Input/output error" [24]="Too many open files" [11]="threads")

# Lines STEP KIND N MODE of all points to choose from: the first call of each place that no earlier step had, and of each kind and
# step some more at equal distances.
same_addresses= # so that a place has one number in all steps
if setarch -R true 2>/dev/null; then same_addresses="setarch -R"; fi
for step in "${steps[@]}"; do
  start_of "$step"
  rm -f calls
  # shellcheck disable=SC2086
  (cd work && LD_PRELOAD=$library FAULT_LOG=../calls FAULT_PLACES=$((points >= 1000)) exec $same_addresses \
    "$grainlaw" ${command[$step]} --quiet) >/dev/null 2>log || (($? == codes[$step])) || fail "$step counted: $(cat log)"
  sed "s/^/$step /" calls
done | awk -v few=$((points / 50 + 2)) '
  $2 == "place" && !known[$5]++ { place[++places] = $3 " " $4 }
  $2 == "count" {
    split("", chosen)
    for (i = 1; i <= places; ++i) { split(place[i], p); if (p[1] == $3) chosen[p[2]] }
    for (n = 1; n <= few && n <= $4; ++n) chosen[int($4 <= few ? n : 1 + (n - 0.5) * $4 / few)]
    for (n in chosen) print $1, $3, n
  }
  $2 == "count" && $3 == "thread" { places = 0 } # the last line of a step' |
  grep -E "^[^ ]+ (${kinds// /|}) " | grep -v "^vtkhdf-export alloc " | sort -k 2,2 -k 1,1 -k 3,3n |
  awk '{ print $0, "once" } NR % 5 == 3 { print $0, "on" }' >candidates
awk -v points="$points" -v all="$(wc -l <candidates)" 'int(NR * points / all) > int((NR - 1) * points / all)' candidates >thinned
for step in "${steps[@]}"; do grep "^$step " thinned || true; done | tail -n "+${FIRST:-1}" >chosen

# One process for each step that loads the libraries; children of it run the command.
serve() { # STEP
  # shellcheck disable=SC1083
  if [[ -n ${SERVER_PID:-} ]]; then exec {SERVER[1]}>&- && wait "$SERVER_PID"; fi
  # shellcheck disable=SC2086
  coproc SERVER { LD_PRELOAD=$library FAULT_SERVE=1 FAULT_LOG=$PWD/struck exec "$grainlaw" ${command[$1]} --quiet; }
}
run_served() { # KIND N MODE ERRNO: exit code in `code`, what it says in work.said and work.log
  rm -f struck
  echo "$PWD/work $*" >&"${SERVER[1]}"
  read -r code <&"${SERVER[0]}"
}

# 1 when something is wrong, 2 when this run made fewer calls
pristine= # the step whose beginning the folder work still is
strike() { # STEP KIND N MODE
  local code line what="$*" all_reasons reason
  wrong() { finding "$what: $*"; return 1; }
  if [[ $pristine != "$1" ]]; then start_of "$1"; fi
  pristine=
  read -ra all_reasons <<<"${reasons[$2]}"
  reason=${all_reasons[$3 % ${#all_reasons[@]}]}
  run_served "$2" "$3" "$4" "$reason"
  read -r line <struck
  [[ $line == struck* ]] || return 2
  what="$what ${line##* } errno $reason, exit code $code"
  if ((code == codes[$1])); then
    if [[ $2 == folder && -n $(leftovers_of work) ]]; then # what could not be removed is by who comes next
      check_unfinished "$1" "$what" || return 1
      run_served none 0 once 0
      ((code == codes[$1])) || wrong "does not go on, exit code $code: $(<work.log)" || return 1
    fi
    check_finished "$1" "$what, of no consequence" || return 1
    cmp -s work.said "reference/$1.said" || [[ $1 == calibrate* || $1 == fit* ]] || wrong "says $(<work.said)"
    return
  fi
  line=$(<work.log)
  [[ $code == 1 || ($code == 2 && $2 != alloc) ]] || wrong "$line" || return 1
  [[ $line == "grainlaw: "?* && $line != *$'\n'* ]] || wrong "$line" || return 1
  [[ $line =~ ${words[$reason]} || ($2 == alloc && $line == "grainlaw: threads: "*) ]] || wrong "no word of it: $line" || return 1
  [[ $line =~ ^"grainlaw: "([^:]+": "|"out of memory") ]] || wrong "names nothing: $line" || return 1
  if diff -r "start/$1" work >/dev/null; then # as before: the same command does what the reference did
    pristine=$1
    return
  fi
  check_unfinished "$1" "$what" || return 1
  run_served none 0 once 0
  ((code == codes[$1])) || wrong "does not go on, exit code $code: $(<work.log)" || return 1
  check_finished "$1" "$what, again"
}

declare -A struck=() sound=()
serving=
while read -r step kind n mode; do
  if [[ $serving != "$step" ]]; then serve "$step" && serving=$step; fi
  outcome=0
  strike "$step" "$kind" "$n" "$mode" || outcome=$?
  if ((outcome == 2)); then continue; fi
  for of in "$kind" "$step" all; do
    struck[$of]=$((${struck[$of]:-0} + 1))
    if ((outcome == 0)); then sound[$of]=$((${sound[$of]:-0} + 1)); fi
  done
done <chosen
for of in $kinds "${steps[@]}" all; do
  printf 'every_fault.%s %s\nevery_fault.%s_sound %s\n' "$of" "${struck[$of]:-0}" "$of" "${sound[$of]:-0}"
done
((${struck[all]:-0} >= $(wc -l <chosen) * 3 / 4)) || fail "only ${struck[all]:-0} of $(wc -l <chosen) calls were struck"
found_nothing
