#!/usr/bin/env bash
# tests/mutants/run.sh [--list | --check | --only IDS | --sample N]: do the tests notice faults in physics and law?
# Sows each fault of tests/mutants/*.txt (--sample: N of them, evenly spaced; --only: those that match a pattern like
# 'dem.lanes_*') into a copy of HEAD in build/mutants/ and runs the room's own tests up to their first failure; at last, for
# those that lived, the default suite but its checks of the sources. Prints "mutant ID caught|survived|invalid by TEST" and
# "mutants.caught N of M"; exit code 0 if none is invalid and 95 % are caught. Finished ones are kept in
# build/mutants/results.txt and not run again for the same sources (the pages of figures aside, which
# none of these tests reads), so that a stopped run goes on. --list: prints them, if all fit the sources; --check: do all compile?
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
mode=run argument=
case $#:${1:-} in
  0:) ;;
  1:--list | 1:--check) mode=${1#--} ;;
  2:--only | 2:--sample) mode=${1#--} argument=$2 ;;
  *) sed -n 's/^# //; 2,8p' "${BASH_SOURCE[0]}" >&2; exit 2 ;;
esac
work=$root/build/mutants
tree=$work/tree            # a clone of its own, so that nothing here can touch the sources
build=$tree/build/release
results=$work/results.txt
jobs=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}
seconds=1800               # a fault may turn a loop endless; the machine may be busy
memory_kB=8000000          # or a list; a browser does not start with so few addresses: without its two tests
die() { echo "mutants: $*" >&2; exit 1; }

# --- The list ------------------------------------------------------------------------------------
ids=() files=() reasons=() olds=() news=()
read_list() {
  local line n=-1 newline=$'\n' entry='^([a-z]+\.[A-Za-z0-9_]+) ([^ :]+): (.+)$'
  while IFS= read -r line; do
    if [[ $line =~ $entry ]]; then
      n=${#ids[@]}
      [[ " ${ids[*]} " != *" ${BASH_REMATCH[1]} "* ]] || die "${BASH_REMATCH[1]} is listed twice"
      ids+=("${BASH_REMATCH[1]}") files+=("${BASH_REMATCH[2]}") reasons+=("${BASH_REMATCH[3]}") olds+=("") news+=("")
    elif [[ $line == '- '* ]]; then
      olds[n]+=${olds[n]:+$newline}${line:2}
    elif [[ $line == '+'* ]]; then
      news[n]+=${news[n]:+$newline}${line:2}
    elif [[ -n $line && $line != '#'* ]]; then
      die "cannot read '$line'"
    fi
  done < <(cat "$here"/*.txt)
}

select_mutants() {
  local i n=${#ids[@]}
  selected=()
  case $mode in
    only)
      # shellcheck disable=SC2053  # a pattern
      for i in "${!ids[@]}"; do [[ ${ids[i]} != $argument ]] || selected+=("$i"); done
      ((${#selected[@]})) || die "no mutant matches $argument; see --list"
      ;;
    sample)
      [[ $argument =~ ^[1-9][0-9]*$ ]] || die "--sample needs a number, not '$argument'"
      if ((argument > n)); then argument=$n; fi
      for ((i = 0; i < argument; ++i)); do selected+=($((i * n / argument))); done
      ;;
    *) selected=("${!ids[@]}") ;;
  esac
}

# --- The copy ------------------------------------------------------------------------------------
copy_sources() {
  mkdir -p "$work/logs" "$work/scratch"
  exec 9>"$work/lock"
  flock -n 9 || die "another run works in $work"
  [[ -d $tree ]] || git clone -q --shared "$root" "$tree"
  git -C "$tree" fetch -q "$root" HEAD
  git -C "$tree" checkout -q --force --detach FETCH_HEAD
  source_digest=$(git -C "$tree" ls-tree -r HEAD -- CMakeLists.txt cmake model dem fit predict chain app tests examples docs |
    grep -vE $'\ttests/(mutants|acceptance|long)/|\tdocs/(validation|performance)(-log)?\\.md$' | sha256sum)
  source_digest=${source_digest%% *}
}

replaced() { # index -> the text of its file with the fault; fails unless the old text occurs exactly once
  local text before after
  text=$(<"$tree/${files[$1]}")
  before=${text%%"${olds[$1]}"*}
  [[ -n ${olds[$1]} && $before != "$text" ]] || die "${ids[$1]}: its old text does not occur in ${files[$1]}"
  after=${text#*"${olds[$1]}"}
  [[ $after != *"${olds[$1]}"* ]] || die "${ids[$1]}: its old text occurs more than once in ${files[$1]}"
  printf '%s\n' "$before${news[$1]}$after"
}

sow() { # index
  local text
  text=$(replaced "$1")
  printf '%s\n' "$text" >"$tree/${files[$1]}"
}

restore() { git -C "$tree" checkout -q -- "${files[$1]}"; }

compile() { # log target...
  cmake --build "$build" --parallel "$jobs" ${2:+--target "${@:2}"} </dev/null >"$1" 2>&1
}

# --- The tests -----------------------------------------------------------------------------------
tests_of() { # room -> its own test executables, one with the precision it runs in
  local kind
  for kind in unit verification; do
    if compgen -G "$tree/tests/$kind/$1/*.cpp" >/dev/null; then echo "${kind}_$1"; fi
  done
  [[ $1 != dem ]] || echo "verification_dem reference"
}

# Sets first_failure to the name of the first failing test of an executable; empty when all pass.
run_executable() { # log name [precision]
  local status=0
  first_failure=
  (cd "$work/scratch" && ulimit -v "$memory_kB" &&
    GRAINLAW_TEST_PRECISION=${3:-full} timeout "$seconds" "$build/bin/$2" --gtest_fail_fast) </dev/null >"$1" 2>&1 || status=$?
  ((status)) || return 0
  first_failure=$(sed -n 's/^\[  FAILED  \] \([^ ,]*\).*/\1/p' "$1" | head -n 1)
  [[ -n $first_failure ]] || first_failure="$(sed -n 's/^\[ RUN      \] //p' "$1" | tail -n 1) (ended with $status)"
  first_failure=$2${3:+.$3}.$first_failure
}

run_suite() { # log
  local status=0
  first_failure=
  (ulimit -v "$memory_kB" && ctest --test-dir "$build" -LE '^(long|architecture)$' -E '^(cli\.page|docs\.site)$' \
    --stop-on-failure --output-on-failure --parallel "$jobs" --timeout "$seconds") \
    >"$1" 2>&1 || status=$?
  ((status)) || return 0
  first_failure=$(sed -n '/^The following tests FAILED:/,$ s/^[[:space:]]*[0-9]* - \([^ ]*\).*/\1/p' "$1" | head -n 1)
  first_failure=${first_failure:-ctest (ended with $status)}
}

# Sets first_failure to the first failing test of a room's own; fails where they do not compile.
run_own_tests() { # room log
  local name precision
  first_failure=
  while read -r name precision; do
    compile "$2.build" "$name" || return 1
    run_executable "$2.$name${precision:+.$precision}" "$name" "$precision"
    [[ -z $first_failure ]] || return 0
  done < <(tests_of "$1")
}

key_of() { # index
  local key
  key=$(printf '%s\0' "$source_digest" "${files[$1]}" "${olds[$1]}" "${news[$1]}" | sha256sum)
  printf '%s' "${key%% *}"
}

known() { # key -> "ID VERDICT TEST"
  [[ -f $results ]] && sed -n "s/^$1 //p" "$results" | tail -n 1
}

# Tests must pass without a fault, else everything would seem to be caught: a room's own, or the suite.
prove_clean() { # room | suite
  local log=$work/logs/clean.$1
  [[ -z $(known "$source_digest.$1") ]] || return 0
  if [[ $1 == suite ]]; then
    compile "$log.build" || die "the sources do not build without a fault: see $log.build"
    run_suite "$log"
  else
    run_own_tests "$1" "$log" || die "the tests of $1 do not build without a fault: see $log.build"
  fi
  [[ -z $first_failure ]] || die "tests fail without any fault: $first_failure (see $log*)"
  echo "$source_digest.$1 clean" >>"$results"
}

judge_by_own_tests() { # index; sets verdict and by
  verdict=invalid by=-
  run_own_tests "${files[$1]%%/*}" "$work/logs/${ids[$1]}" || return 0
  if [[ -n $first_failure ]]; then verdict=caught by=$first_failure; else verdict=lived; fi
}

judge_by_suite() { # index; sets verdict and by
  local log=$work/logs/${ids[$1]}
  verdict=invalid by=-
  compile "$log.build" || return 0
  run_suite "$log.suite"
  if [[ -n $first_failure ]]; then verdict=caught by=$first_failure; else verdict=survived; fi
}

# -------------------------------------------------------------------------------------------------
read_list
select_mutants
if [[ $mode == list ]]; then
  tree=$root
  for i in "${selected[@]}"; do replaced "$i" >/dev/null; done
  for i in "${selected[@]}"; do printf '%s %s: %s\n' "${ids[i]}" "${files[i]}" "${reasons[i]}"; done
  exit 0
fi
copy_sources
for i in "${selected[@]}"; do replaced "$i" >/dev/null; done
# not united: a fault costs the compilation of one file, or of those that include it
(cd "$tree" && cmake --preset release --log-level=WARNING -DGRAINLAW_LONG=OFF -DGRAINLAW_UNITY=OFF >&2)

if [[ $mode == check ]]; then
  invalid=0
  compile "$work/logs/clean.build" grainlaw_{model,dem,fit,predict,chain,app} ||
    die "the sources do not build without a fault: see $work/logs/clean.build"
  for i in "${selected[@]}"; do
    sow "$i"
    compile "$work/logs/${ids[i]}.build" "grainlaw_${files[i]%%/*}" ||
      { echo "mutant ${ids[i]} invalid: see $work/logs/${ids[i]}.build"; invalid=$((invalid + 1)); }
    restore "$i"
  done
  echo "mutants.compiled $((${#selected[@]} - invalid)) of ${#selected[@]}"
  ((invalid == 0))
  exit
fi

# First all by their own room's tests, which takes little; then those that lived by the suite.
caught=0 invalid=0
finish() { # index
  echo "mutant ${ids[$1]} $verdict by $by"
  case $verdict in
    caught) caught=$((caught + 1)) ;;
    invalid) invalid=$((invalid + 1)) ;;
  esac
}
for judge in own_tests suite; do
  lived=()
  for i in "${selected[@]}"; do
    key=$(key_of "$i")
    read -r _ verdict by < <(known "$key" || true) || verdict=
    if [[ -z ${verdict:-} || ($judge == suite && $verdict == lived) ]]; then
      if [[ $judge == suite ]]; then prove_clean suite; else prove_clean "${files[i]%%/*}"; fi
      sow "$i"
      "judge_by_$judge" "$i"
      restore "$i"
      echo "$key ${ids[i]} $verdict $by" >>"$results"
    fi
    if [[ $verdict == lived ]]; then lived+=("$i"); else finish "$i"; fi
  done
  total=${total:-${#selected[@]}}
  selected=("${lived[@]}")
done
echo "mutants.caught $caught of $total"
((invalid == 0 && 100 * caught >= 95 * total))
