#!/usr/bin/env bash
# tests/full.sh [--plan | --again] [STAGE...]: the suites and acceptance scripts of the stages below, or of the named ones alone.
#   --plan   only says what would run and how long that takes
#   --again  runs stages, too, that have passed with these very sources
# A stage that fails does not stop the others. Stopped and called again it goes on with what has not passed yet.
# Leaves build/full/summary.md, and for each stage build/full/STAGE.log. Exit code 0 only if all these stages passed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# Each stage and its minutes on two cores, compiler cache empty, where no run has said it here.
stages=(release 17  long 120 clang 30  sources 20  assertions 35  asan-ubsan 60  tsan 110  valgrind 60  fuzz 32
        faults 65  kills 12  mutants 240  trust 20  pipeline 20  engine 15  ground 60  truth 15  own_data 15  page 30
        cluster 30  house 25  calibration 55  law 150)
folder=build/full
export UBSAN_OPTIONS=print_stacktrace=1
jobs=$(nproc)
options=(-DGRAINLAW_LONG=ON)
if [[ ${CI:-false} == true ]]; then options+=(-DGRAINLAW_WERROR=ON); fi

build() { # preset option...
  local begin=$SECONDS
  cmake --preset "$1" --log-level=WARNING "${@:2}"
  cmake --build "build/$1" --parallel "$jobs"
  echo "built $1 in $((SECONDS - begin)) s"
}

run() { # stage; what it says of itself goes to its log. Exit code 77: left out.
  case $1 in
    clang | sources | asan-ubsan | fuzz) command -v clang++-14 || return 77 ;;
    valgrind) command -v valgrind || return 77 ;;
  esac
  case $1 in
    release) build release "${options[@]}"; ctest --preset release --parallel $((3 * jobs)) ;;
    long) build release "${options[@]}"; ctest --test-dir build/release -L '^long$' --verbose --parallel "$jobs" ;;
    clang | assertions | asan-ubsan | tsan) build "$1"; ctest --preset "$1" --parallel "$jobs" ;;
    sources) build sources ;;
    valgrind) build assertions; tests/valgrind.sh ;;
    fuzz) build release "${options[@]}"; tests/fuzz/run.sh --seconds 60 --grainlaw build/release/bin/grainlaw ;;
    ground | calibration | truth)  # which ask for figures of the long tests, too
      ! up_to_date long || export LONG_LOG=$PWD/$folder/long.log
      bash "tests/acceptance/$1.sh" ;;
    faults | kills | mutants) bash tests/acceptance/trust.sh "$1" ;;  # apart, so that a stop costs less
    trust) bash tests/acceptance/trust.sh finds digits stress conserved time_line suites ;;
    *) bash "tests/acceptance/$1.sh" ;;
  esac
}

# --- What is known of a stage: build/full/STAGE.result, DIGEST VERDICT SECONDS DATE COUNTS..., then what failed -----------
judges_of() { # script of tests/acceptance: it, what all of them begin with, and what these call, as " a.sh b.sh "
  local seen=" $1 setup.sh figures.sh " queue=("$1" setup.sh figures.sh) name
  while ((${#queue[@]} > 0)); do
    for name in $(grep -ohE '[a-z_]+\.sh' "tests/acceptance/${queue[0]}" 2>/dev/null | sort -u); do
      if [[ -e tests/acceptance/$name && $seen != *" $name "* ]]; then seen+="$name " queue+=("$name"); fi
    done
    queue=("${queue[@]:1}")
  done
  echo "$seen"
}

left_out_of() { # stage: patterns of files that do not matter to it. Pages do to none: their tests are part of every CI run
  local judges other
  echo '*.md'
  case $1 in
    release | all) return ;;
    long | clang | sources | assertions | asan-ubsan | tsan | valgrind | fuzz)  # build and test alone
      printf '%s\n' tests/full.sh tests/coverage.sh 'tests/acceptance/*' 'tests/mutants/*'
      return ;;
    faults | kills | mutants) judges=$(judges_of trust.sh) ;;
    *) judges=$(judges_of "$1.sh") ;;
  esac
  for other in tests/acceptance/*.sh; do
    if [[ $judges != *" ${other##*/} "* ]]; then echo "$other"; fi
  done
}

digest_of_sources() ( # stage, or all: of what matters to it, committed or not
  mapfile -t left_out < <(left_out_of "$1")
  if git rev-parse --git-dir >/dev/null 2>&1; then
    export GIT_INDEX_FILE=$folder/index.$BASHPID  # another call may ask at the same time
    trap 'rm -f "$GIT_INDEX_FILE"' EXIT
    git add --all . 2>/dev/null
    git rm -r --cached --quiet --ignore-unmatch -- "${left_out[@]}"
    git write-tree
  else
    but=()
    for pattern in "${left_out[@]}"; do but+=(! -path "./$pattern"); done
    find . -path ./build -prune -o -type f "${but[@]}" -print0 | sort -z | xargs -0 sha256sum | sha256sum | cut -c 1-40
  fi
)

known() { # stage field
  [[ -s $folder/$1.result ]] && head -1 "$folder/$1.result" | cut -d ' ' -f "$2"
}

up_to_date() { [[ $(known "$1" 1) == "${digest[$1]}" ]]; }

passed() { up_to_date "$1" && [[ $(known "$1" 2) == passed ]]; }

seconds_of() { # stage: what it took when it last passed, or the estimate
  if [[ $(known "$1" 2) == passed ]]; then known "$1" 3; else echo $((60 * minutes[$1])); fi
}

counts() { # stage: what its log says
  awk '
    / Test +#[0-9]+: .* Passed +[0-9.]+ sec/ { tests++ }
    / Test +#[0-9]+: .*\*\*\*(Skipped|Not Run)/ { skipped++ }
    / Test +#[0-9]+: .*\*\*\*/ && !/Skipped|Not Run/ { failed++ }
    /ERROR: [A-Za-z]*Sanitizer|WARNING: ThreadSanitizer|: runtime error: / { reports++ }
    /^valgrind: .* ok$/ { programs++ }
    /^valgrind: .* FAILED/ { reports++ }
    /^[^ ]+ [^ ]+ [^ ]+ ok$/ && !/^valgrind:/ { figures++ }
    /^[^ ]+ [^ ]+ [^ ]+ short$/ && $3 !~ /^aim/ && !/figures are short$/ { short++ }
    /^[^ ]+ [^ ]+ aim<=[^ ]+ short$/ { aims++ }
    NF == 6 && $2 $3 $4 $5 $6 ~ /^[0-9.-]+$/ { readers++; findings += $6 }
    /^built [^ ]+ in [0-9]+ s$/ { built = $4 }
    NF { gsub(/\|/, "/"); last = $0 }
    END {
      if (tests + failed) printf "%d tests passed, %d skipped, %d failed", tests, skipped, failed
      if (programs) printf "%d programs without an error", programs
      if (readers) printf "%d readers, %d with findings", readers, findings
      if (figures + short) printf "%d figures within bounds, %d short%s", figures, short, (aims ? ", " aims " short of an aim" : "")
      if (reports) printf "%s%d reports of errors", (tests + failed + programs ? ", " : ""), reports
      if (!(tests + failed + programs + readers + figures + short + reports)) printf "ended with: %s", substr(last, 1, 100)
      if (built > 10) printf "; built in %d s", built
    }' "$folder/$1.log"
}

failures() { # stage: names of failed tests and short figures
  sed -nE -e 's/^ *[0-9]+\/[0-9]+ Test +#[0-9]+: ([^ ]+) .*\*\*\*(Failed|Timeout|Exception).*/\1/p' \
    -e '/figures are short$/d' -e 's/^([^ ]+ [^ ]+ [^ ]+) short$/\1/p' -e 's/^valgrind: ([^ ]+), .* FAILED$/\1/p' "$folder/$1.log" | sort -u
}

# --- Saying what is going on -------------------------------------------------------------------------------------------------
clock() { date -d "@$1" +%H:%M; }

plan() {
  local k=0 total=0 seconds stage
  for stage in "${wanted[@]}"; do
    k=$((k + 1)) seconds=$(seconds_of "$stage")
    if [[ $again == no ]] && passed "$stage"; then
      printf '%2d %-12s           passed with these sources on %s\n' $k "$stage" "$(known "$stage" 4)"
    else
      printf '%2d %-12s %4d min  %s\n' $k "$stage" $((seconds / 60)) \
        "$([[ $(known "$stage" 2) == passed ]] && echo "as last time" || echo "estimate")"
      total=$((total + seconds))
    fi
  done
  printf 'To do: %d h %d min\n' $((total / 3600)) $((total % 3600 / 60))
}

remaining() { # seconds of the stages from number $1 on that are still to run
  local k sum=0
  for ((k = $1; k < ${#wanted[@]}; k++)); do
    if [[ $again == yes ]] || ! passed "${wanted[k]}"; then sum=$((sum + $(seconds_of "${wanted[k]}"))); fi
  done
  echo $sum
}

follow() { # pid number stage: says how far it is, on a terminal in one line, else every five minutes
  local begin=$SECONDS told=0 every=300 later at left
  later=$(remaining "$2")
  [[ -t 2 ]] && every=2
  while kill -0 "$1" 2>/dev/null; do
    sleep 1
    if ((SECONDS - told < every)); then continue; fi
    told=$SECONDS
    at=$(tail -c 4000 "$folder/$3.log" | grep -aoE '^ *\[?[0-9]+/[0-9]+' | tail -1 | tr -d ' [') || true
    left=$(($(seconds_of "$3") - SECONDS + begin))
    printf '%s[%d/%d] %s: %d of about %d min%s; all done at about %s%s' "$([[ -t 2 ]] && printf '\r')" "$2" ${#wanted[@]} "$3" \
      $(((SECONDS - begin) / 60)) $(($(seconds_of "$3") / 60)) "${at:+, at $at}" \
      "$(clock $((EPOCHSECONDS + later + (left > 0 ? left : 0))))" "$([[ -t 2 ]] && printf '\e[K' || echo)" >&2
    [[ -t 2 ]] || echo >&2
  done
  [[ -t 2 ]] && printf '\r\e[K' >&2
  return 0
}

summary() {
  local stage
  echo "Sources: tree ${digest[all]} (without pages), commit $(git rev-parse --short HEAD 2>/dev/null || echo none)$(
    [[ -z $(git status --porcelain 2>/dev/null) ]] || echo " and changes"); $(nproc) cores, $(g++ --version | head -1)."
  echo
  echo "| Stage | Verdict | Minutes | What ran |"
  echo "|---|---|---|---|"
  for stage in "${wanted[@]}"; do
    if up_to_date "$stage"; then
      echo "| $stage | $(known "$stage" 2 | tr _ ' ') | $(($(known "$stage" 3) / 60)) | $(known "$stage" 5-) |"
    else
      echo "| $stage | not run | | |"
    fi
  done
  for stage in "${wanted[@]}"; do
    if ! up_to_date "$stage" || [[ $(tail -n +2 "$folder/$stage.result" | wc -l) == 0 ]]; then continue; fi
    echo
    echo "$stage: $(tail -n +2 "$folder/$stage.result" | paste -sd , | sed 's/,/, /g')"
  done
}

# --- The run ------------------------------------------------------------------------------------------------------------
again=no plan_only=no wanted=() names=()
declare -A minutes
for ((k = 0; k < ${#stages[@]}; k += 2)); do
  names+=("${stages[k]}")
  minutes[${stages[k]}]=${stages[k + 1]}
done
for argument in "$@"; do
  case $argument in
    --again) again=yes ;;
    --plan) plan_only=yes ;;
    *) if [[ -z ${minutes[$argument]:-} ]]; then
         sed -n 's/^# //; 2,6p' "${BASH_SOURCE[0]}" >&2
         echo "Stages: ${names[*]}" >&2
         exit 2
       fi
       wanted+=("$argument") ;;
  esac
done
if ((${#wanted[@]} == 0)); then wanted=("${names[@]}"); fi
mkdir -p $folder
declare -A digest
for stage in "${names[@]}" all; do digest[$stage]=$(digest_of_sources "$stage"); done
plan >&2
if [[ $plan_only == yes ]]; then exit; fi
./install-packages.sh --full >&2

pid=
trap '[[ -z $pid ]] || kill -- "-$pid" 2>/dev/null; summary >$folder/summary.md; exit 130' INT TERM HUP
status=0
for ((k = 0; k < ${#wanted[@]}; k++)); do
  stage=${wanted[k]}
  if [[ $again == no ]] && passed "$stage"; then continue; fi
  begin=$SECONDS code=0
  echo "[$((k + 1))/${#wanted[@]}] $stage, begun at $(date +%H:%M), log $folder/$stage.log" >&2
  set -m  # a process group of its own, which can be stopped as a whole
  (set -e; run "$stage") >"$folder/$stage.log" 2>&1 </dev/null &
  pid=$!
  set +m
  follow $pid $((k + 1)) "$stage"
  wait $pid || code=$?
  pid=
  verdict=failed
  case $code in 0) verdict=passed ;; 77) verdict=left_out ;; esac
  if [[ $(digest_of_sources "$stage") != "${digest[$stage]}" ]]; then verdict=sources_changed; fi
  {
    echo "${digest[$stage]} $verdict $((SECONDS - begin)) $(date +%F) $(counts "$stage")"
    failures "$stage"
  } >"$folder/$stage.result"
  if [[ $verdict == failed || $verdict == sources_changed ]]; then status=1; fi
  echo "[$((k + 1))/${#wanted[@]}] $stage: ${verdict/_/ } after $(((SECONDS - begin) / 60)) min: $(counts "$stage")" >&2
  summary >$folder/summary.md
done
summary | tee $folder/summary.md
exit $status
