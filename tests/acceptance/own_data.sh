#!/usr/bin/env bash
# tests/acceptance/own_data.sh [--quick]: data, tools and formats of others, one line each:
#   NAME VALUE BOUND ok|short          exit 0 only if none is short
# Averages of LAMMPS's and YADE's particles beside their own stress and beside numpy, a law from LAMMPS's tests beside that of our
# engine, what friction does to it, each export opened by its consumer, Python, executions of the readers' fuzzing.
# --quick: without the tests of the readers' fuzzing. All data are the shipped tables and samples; examples/import makes them anew.
set -euo pipefail

# shellcheck source=tests/acceptance/setup.sh
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" "$@"
./install-packages.sh --full >&2
python=/usr/bin/python3
lammps=examples/import/lammps yade=examples/import/yade
work=$out/own_data
rm -rf "$work"
mkdir -p "$work"

# Largest differences of two tables, as NAME VALUE; tests/acceptance/own_data.py says how.
compared() { # name bound KIND ARGUMENT...
  local name=$1 bound=$2
  shift 2
  figure "$name" "$($python tests/acceptance/own_data.py "$@" || echo missing)" "$bound"
}

# Particles of others: our averages beside their own stress, and beside definitions written down again with numpy.
averages() {
  local sample=$work/sample
  "$bin/grainlaw" import $lammps/sample/mapping.json -o "$sample/lammps" --quiet >/dev/null
  $python $lammps/averages.py $lammps/sample "$sample/numpy" 17
  compared averages.lammps.stress_beside_lammps "<=1e-10" normal_stress "$sample/lammps/D2.csv" $lammps/sample/packing-9/D2.csv
  compared averages.lammps.stress_beside_numpy "<=1e-10" stress "$sample/lammps/D2.csv" "$sample/numpy/packing-9/D2.csv"
  compared averages.lammps.fabric_beside_numpy "<=1e-10" fabric "$sample/lammps/D2.csv" "$sample/numpy/packing-9/D2.csv"
  compared averages.lammps.contacts_beside_numpy "<=1e-10" contacts "$sample/lammps/D2.csv" "$sample/numpy/packing-9/D2.csv"
  "$bin/grainlaw" import $yade/sample/mapping.json -o "$sample/yade" --quiet >/dev/null
  # export.text writes six digits of a position; at rest the forces on a sphere cancel, and with them what that does to the stress
  compared averages.yade.stress_beside_yade "<=1e-8" stress "$sample/yade/D2.csv" $yade/sample/D2.csv
}

# LAMMPS's tests to a law, beside the law of our engine from the same tests, and uniaxial compression that no fit saw.
law() { # data
  examples/import/friction.sh "$work/laws" "$1" >"$work/friction.md"
  "$bin/grainlaw" calibrate examples/import/engine.json -o "$out/own_data_engine" --quiet >/dev/null || (($? == 3))
  local lines
  lines=$($python tests/acceptance/own_data.py parameters "$work/laws/mu0/parameters.json" "$out/own_data_engine/parameters.json" "$work/parameters.md")
  while read -r name value; do
    case $name in
      compared) figure law.parameters_with_errors "$value" ">=15" ;;
      agree) figure law.share_within_95_percent "$value" ">=0.9" ;;
      largest) figure law.largest_distance_over_95_percent "$value" stated ;;
    esac
  done <<<"$lines"
  local quantity error
  for quantity in P_star:"<=0.02" s_par:"<=0.25" F_par:"<=0.4"; do
    error=$(jq -s --arg q "${quantity%%:*}" '[.[].comparisons[] | select(.seed == null and .initial == "law" and .model == "reduced")
      .quantities[] | select(.quantity == $q).normalised_rms] | if length > 0 then add / length else "missing" end' "$work"/laws/mu0/predictions/*/comparison.json)
    figure "law.uniaxial_error.${quantity%%:*}" "$error" "${quantity#*:}"
  done
  "$bin/grainlaw" report "$work/laws/mu0" -o "$work/report.html" --quiet >/dev/null
  figure law.report.numbers "$("$bin/grainlaw" report "$work/laws/mu0" --json --quiet | jq '[.. | numbers] | length')" ">=3000"
}

# Tests of the build by name: how many there are, and how many failed.
tests_of() { # name regular-expression least
  local log=$work/$1.txt
  ctest --test-dir build/release -R "$2" --verbose >"$log" || true
  figure "$1.tests" "$(grep -cE 'Test +#[0-9]+:.*Passed' "$log" || true)" ">=$3"
  figure "$1.failed_or_skipped" "$(grep -cE 'Test +#[0-9]+:.*(Failed|Skipped|Timeout)' "$log" || true)" "<=0"
}

# Friction: the tables that docs/friction.md speaks of, and the two figures that its answer rests on.
friction() {
  figure friction.rows_of_tables "$(grep -c '^|' "$work/friction.md" || true)" ">=50"
  local mu
  for mu in 0.1 0.5; do
    figure "friction.uniaxial_error.P_star.mu$mu" "$(jq -s '[.[].comparisons[] | select(.seed == null and .initial == "law" and .model == "reduced")
      .quantities[] | select(.quantity == "P_star").normalised_rms] | if length > 0 then add / length else "missing" end' "$work/laws/mu$mu"/predictions/*/comparison.json)" "<=0.05"
  done
}

# What Python adds to a call of the shipped data's law, which was rehearsed, and how soon it stops; both programs in turns on one
# core. 5e-5 yardsticks are 5 us where the yardstick is .1 s.
python_calls() {
  local line judged=0
  "$bin/grainlaw" calibrate --dataset examples/paper/data/dataset -o "$work/rehearsed" --quiet >/dev/null
  tests_of python '^python\.' 8
  figure python.interrupt_to_end.seconds "$(sed -n 's/.*figure python.interrupt.seconds \([0-9.]*\).*/\1/p' "$work/python.txt")" "<=1"
  while read -r line; do
    case $line in
      overhead.*)  # a difference, which may be negative
        figure "python.${line%% *}.us" "${line##* }" stated
        figure "python.${line%% *}.yardsticks" "$(awk -v us="${line##* }" -v yardstick="$(yardstick)" 'BEGIN { printf "%.4g", 1e-6 * us / yardstick }')" "<=5e-5"
        ;;
      batch.speed*) figure python.batch.speed_over_cpp "${line##* }" ">=0.9" ;;
      *) continue ;;
    esac
    judged=$((judged + 1))
  done < <(PYTHONPATH=build/release/python taskset -c 0 $python tests/bench/python_law.py "$bin/bench_law_calls" "$work/rehearsed/parameters.json")
  figure python.calls_judged $judged ">=5"  # none where the program failed
}

# What frames on the way of D2 cost, 1000 spheres, defaults otherwise: the command with and without, in turns on one core, least times
# of eleven. Of 25 frames that is less than what two least times differ by on a machine whose hours differ (3 %), so that it is a
# sixteenth of what 400 cost; what 25 seem to cost themselves is stated.
frames() {
  local turn kind cost=()
  jq -n '{particles: 1000, strain_rate: 552, rows: 100, initial: {nu: 0.72}, segments: [{mode: "D2", extent: {eps_dev: 0.1}}]}' >"$work/frames.json"
  "$bin/grainlaw" simulate "$work/frames.json" -o "$work/frames" --quiet >/dev/null
  jq -n --arg state "$work/frames/end.state" '{state: $state, segments: [{mode: "D2", extent: {eps_dev: 0.3}}]}' >"$work/sheared.json"
  for turn in {1..11}; do
    for kind in 0 25 400; do
      seconds_of taskset -c 0 "$bin/grainlaw" simulate "$work/sheared.json" -o "$work/sheared-$kind-$turn" --frames "$kind" --threads 1 --quiet >>"$work/seconds-$kind"
    done
  done
  for kind in 25 400; do
    cost[kind]=$(for file in "$work"/seconds-{0,$kind}; do sort -g "$file" | head -1; done |
      awk 'NR == 1 { plain = $1 } END { printf "%.4f", $1 / plain - 1 }')
    figure "frames.cost.$kind" "${cost[kind]}" stated
  done
  figure frames.cost.25_of_400 "$(awk -v cost="${cost[400]}" 'BEGIN { printf "%.4f", cost / 16 }')" "<=0.03"
}

averages
law $lammps/data
friction
tests_of export '^cli\.export' 1
python_calls
frames
if [[ $quick == no ]]; then tests_of fuzz 'fuzz' 1; fi
finish_figures
