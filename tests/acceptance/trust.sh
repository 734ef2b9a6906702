#!/usr/bin/env bash
# tests/acceptance/trust.sh [--quick] [PART...]: what a stranger may rely on, one line each:
#   NAME VALUE BOUND ok|short          exit 0 only if none is short
# What was lost or overwritten once; calls of the system that fail and kills all along the chain; digits over threads and builds;
# stress against the energy and what is conserved; the chain's time line; the suites as tests/full.sh left them.
# --quick: few faults and kills, no hostile files, no mutants, suites only where they ran; four minutes.
# PART: finds, faults, kills, digits, stress, conserved, time_line, suites, mutants; none: all, in five hours and a half.
set -euo pipefail

options=() parts=()
for argument in "$@"; do
  case $argument in
    finds | faults | kills | digits | stress | conserved | time_line | suites | mutants) parts+=("$argument") ;;
    *) options+=("$argument") ;;
  esac
done
set -- "${options[@]}"  # what is sourced without arguments takes those of the script
# shellcheck source=tests/acceptance/setup.sh
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" "$@"
points=10000 moments=1000
[[ $quick == no ]] || points=60 moments=8

# Each find of a stranger has a test with its message.
finds() {
  local name names="nothing_lost refusals interrupt lies"
  [[ $quick == yes ]] || names+=" hostile_files" # three minutes
  for name in $names; do
    figure "finds.$name" "$(ctest --test-dir build/release -R "^cli.$name\$" >"$out/$name.ctest" 2>&1 && echo 0 || echo 1)" "<=0"
  done
}

faults() {
  local kind
  shell_test survival/every_fault POINTS=$points
  for kind in alloc write fsync rename open read folder thread; do
    figure "faults.$kind" "$(value_of "every_fault.$kind" "$out/every_fault.txt")" stated
  done
  figure faults.all "$(value_of every_fault.all "$out/every_fault.txt")" ">=$((points * 3 / 4))"
  figure faults.unsound "$(awk '$1 == "every_fault.all" { a = $2 } $1 == "every_fault.all_sound" { b = $2 } END { print (a == "" ? "missing" : a - b) }' \
    "$out/every_fault.txt")" "<=0"
}

kills() {
  shell_test survival/chain_kills KILLS=$moments
  figure kills.all "$(value_of chain_kills.kills "$out/chain_kills.txt")" ">=$moments"
  figure kills.sound "$(value_of chain_kills.sound "$out/chain_kills.txt")" ">=$moments"
}

# One calibration from packings to parameters by so many threads, and by other builds where there are any: values that differ.
digits() {
  local folder=$out/digits threads build
  rm -rf "$folder"
  mkdir -p "$folder"
  echo '{"particles": 300, "seeds": [1, 2], "strain_rate": 2000, "rows": 30, "nu_end": 0.67, "densities": [0.70, 0.75, 0.80],
    "tests": [{"mode": "ISO", "role": "calibration"}, {"mode": "D2", "role": "calibration", "strain": 0.2}]}' >"$folder/spec.json"
  by() { # name program threads
    "$2" calibrate "$folder/spec.json" -o "$folder/$1" --threads "$3" --quiet >/dev/null 2>&1 || true  # what it lacks is missing below
    jq -S 'del(.provenance)' "$folder/$1/parameters.json" >"$folder/$1.json" || echo missing >"$folder/$1.json"
  }
  differing() { # name
    cmp -s "$folder/threads-1.json" "$folder/$1.json" && echo 0 || echo 1
  }
  for threads in 1 2 3 7 16 64; do
    by "threads-$threads" "$bin/grainlaw" $threads
    figure "digits.threads_$threads.differ" "$(differing "threads-$threads")" "<=0"
  done
  for build in clang assertions asan-ubsan; do
    [[ -x build/$build/bin/grainlaw ]] || continue
    by $build "build/$build/bin/grainlaw" 2
    figure "digits.$build.series_that_differ" "$(for file in "$folder"/threads-1/dataset/*.csv; do cmp -s "$file" "$folder/$build/dataset/$(basename "$file")" || echo x; done | wc -l)" stated
    figure "digits.$build.largest_difference_over_error" "$(jq -s '[.[0].parameters as $a | .[1].parameters as $b | $a | keys[] |
      select($a[.].standard_error != null and $a[.].standard_error > 0) | ($a[.].value - $b[.].value | fabs) / $a[.].standard_error] | max' \
      "$folder/threads-1.json" "$folder/$build.json")" stated
  done
}

stress() { figures_of_tests $bin/verification_dem '*.D7*' D7.random D7.relaxed; }

# What the engine has to conserve, over 10^9 particle-steps (docs/conserved.md).
conserved() {
  local name value bound options=()
  [[ $quick == no ]] || options=(--small)
  examples/conserved/run.sh "$out/conserved" "${options[@]}" >"$out/conserved.txt" 2>"$out/conserved.log" || tail -3 "$out/conserved.log" >&2
  for name in double.momentum double.volume mixed.volume mixed.momentum mixed.energy double.energy double.half_step.energy double.particle_steps; do
    value=$(value_of "conserved.$name" "$out/conserved.txt")
    case $name in
      double.momentum | *.volume) bound="<=1e-12" ;;
      double.particle_steps) bound=$([[ $quick == yes ]] && echo stated || echo ">=9e8") ;;
      *) bound=stated ;;
    esac
    figure "conserved.$name" "$value" "$bound"
  done
  figure conserved.energy.falls_with_half_the_step "$(awk '$1 == "conserved.double.energy" { a = $2 } $1 == "conserved.double.half_step.energy" { b = $2 }
    END { print (b > 0 ? a / b : "missing") }' "$out/conserved.txt")" ">=1.8"
}

# The chain's time line: seconds of its runs by kind, what is left for planning, fit and files, and how busy its threads were.
time_line() {
  local folder=$out/time-line kind TIMEFORMAT='%R %U %S'
  rm -rf "$folder"
  { time $bin/grainlaw calibrate examples/quickstart/spec.json -o "$folder" --threads 2 --quiet >/dev/null 2>&1; } 2>"$out/time-line.txt" ||
    true # what it lacks is missing below
  for kind in preparation test; do
    figure "time_line.$kind.seconds" "$(jq -s --arg kind $kind '[.[] | select(.kind == $kind) | .cost.seconds] | add // "missing"' \
      "$folder"/runs/*/run.json)" stated
  done
  figure time_line.wall.seconds "$(cut -d ' ' -f 1 "$out/time-line.txt")" stated
  figure time_line.threads_busy_percent "$(awk '{ print 100 * ($2 + $3) / (2 * $1) }' "$out/time-line.txt")" ">=80"
}

suites() {
  local stage
  for stage in release clang assertions asan-ubsan tsan valgrind fuzz; do
    if [[ $quick == yes && ! -s build/full/$stage.result ]]; then
      echo "suite $stage: not run here" >&2
      continue
    fi
    figure "suites.$stage.minutes" "$(awk 'NR == 1 { if ($2 == "passed") print $3 / 60; else print $2; n = 1 } END { if (!n) print "not_run" }' \
      "build/full/$stage.result" 2>/dev/null || echo not_run)" stated
  done
}

mutants() {
  tests/mutants/run.sh >"$out/all_mutants.txt" 2>"$out/all_mutants.log" || true
  figure mutants.caught_percent "$(awk '$1 == "mutants.caught" && $4 > 0 { print 100 * $2 / $4; n = 1 } END { if (!n) print "missing" }' "$out/all_mutants.txt")" ">=95"
}

if ((${#parts[@]} == 0)); then
  parts=(finds faults kills digits stress conserved time_line suites)
  [[ $quick == yes ]] || parts+=(mutants)
fi
for part in "${parts[@]}"; do $part; done
finish_figures
