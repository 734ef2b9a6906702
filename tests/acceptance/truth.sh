#!/usr/bin/env bash
# tests/acceptance/truth.sh [--quick]: no silent wrong number, one line each:
#   NAME VALUE BOUND ok|short          exit 0 only if none is short
#   random_paths.*      the law on paths that nobody would choose: failures, slowest, beside another integrator, other axes
#   turns.*, spin.*     continuity in the angle of a turn, rotation, slopes through both
#   rung.*              a rung that fails beside others
#   bands.*             each rehearsed path against the bands of the others: share of rows whose mean of runs, or single
#                       run, lies within; bias of the law there in units of w (docs/theory/bands.md), by path, and its error
#   few.*               coverage of intervals from two to ten packings, by simulation
#   lie.*               what is wrong with data, each with its message (written to lies.txt)
# --quick: 2000 random paths in place of 10,000, and few packings by the suite's study in place of the long one.
# Run it alone: the slowest path has a bound in time. Four minutes with --quick.
set -euo pipefail

# shellcheck source=tests/acceptance/setup.sh
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" "$@"
out+=/truth
mkdir -p "$out"

passed() { # name executable filter least-number-of-tests
  local log
  log=$("$bin/$2" --gtest_filter="$3" 2>&1) || true
  figure "$1.failed" "$(sed -n 's/^ *\([0-9]*\) FAILED TEST.*/\1/p' <<<"$log" | grep . || echo 0)" "<=0"
  figure "$1.passed" "$(sed -n 's/^\[  PASSED  \] \([0-9]*\) test.*/\1/p' <<<"$log" | grep . || echo 0)" ">=$4"
}

every_path() {
  local paths=10000 log=$out/random_paths.txt
  [[ $quick == yes ]] && paths=2000
  GRAINLAW_RANDOM_PATHS=$paths taskset -c 0 "$bin/verification_predict" --gtest_filter='RandomPaths.*' >"$log" 2>&1 || true
  figure random_paths.paths "$paths" stated
  while read -r _ name value bound; do figure "$name" "$value" "<=$bound"; done < <(grep -E '^figure( [^ ]+){3}$' "$log")
  figure_of_time random_paths.slowest "$(awk '$1 == "slowest_seconds" { print $2 }' "$log" | grep . || echo missing)" "<=0.42"
  passed turns verification_predict 'Turns.*' 1
  passed spin verification_predict 'Spin.*:Sensitivity.GoesOnWhereShearTurns*:Integrators.FollowWhatTurns*' 3
  passed spin_in_the_fit unit_fit 'DataSet.RefusesSpin' 1
}

bands() {
  local law=$out/law
  rm -rf "$law" "$out/bands"
  $bin/grainlaw calibrate --dataset examples/paper/data/dataset -o "$law" --quiet >/dev/null
  $bin/grainlaw study bands "$law" -o "$out/bands" --quiet >"$out/bands.txt"
  local rung quantity paths without mean single least
  while read -r rung quantity paths without mean single least; do
    figure "bands.$rung.$quantity.paths" "$paths" ">=7"
    figure "bands.$rung.$quantity.without_the_laws_own" "$without" stated
    figure "bands.$rung.$quantity.mean" "$mean" ">=0.93"
    figure "bands.$rung.$quantity.mean" "$mean" "<=0.97"
    figure "bands.$rung.$quantity.least_path" "$least" ">=0.80"
    figure "bands.$rung.$quantity.single" "$single" ">=0.93"
    figure "bands.$rung.$quantity.single" "$single" "<=0.97"
  done < <(jq -r '.summaries[] | [.model, .quantity, .paths, .without, .mean, .single, .least_mean] | @tsv' "$out/bands/study.json")
  while read -r name; do figure "${name% *}" "${name##* }" stated; done \
    < <(jq -r '.coverages[] | select(.model == "memory") | "\(.path).\(.quantity)" as $of |
               "bias.\($of) \(.bias)", "bias_error.\($of) \(.bias_error)"' "$out/bands/study.json")
}

few_packings() {
  local executable=long
  [[ $quick == yes ]] && executable=verification_fit
  tests_by_filter "$bin/$executable" '*CoverageModerated*' >"$out/few.txt" || true
  figure few.failed "$(grep -c '^\[  FAILED  \].*(.* ms)$' "$out/few.txt" || true)" "<=0"
  while read -r _ name value _; do  # the goals, which are narrower than the tests' own bounds
    case $name in
      *.not_covered_at_most) figure "few.$name" "$value" "<=0.07" ;;
      *.covered_at_most) figure "few.$name" "$value" "<=0.97" ;;
    esac
  done < <(grep -E '^figure( [^ ]+){3}$' "$out/few.txt")
}

lies() {
  ctest --test-dir build/release -R '^cli\.lies$' --verbose >"$out/lies.log" 2>&1 || true
  grep -o "lie '.*" "$out/lies.log" >"$out/lies.txt" || true
  figure lie.passed "$(grep -c 'cli\.lies .*Passed' "$out/lies.log" || true)" ">=1"
  figure lie.refused_by_name "$(wc -l <"$out/lies.txt")" ">=37"
  passed lie.engine unit_dem '*Refuse*' 3
}

every_path
passed rung unit_chain 'PathPrediction.*' 7
bands
few_packings
lies
finish_figures
