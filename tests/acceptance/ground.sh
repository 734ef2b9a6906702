#!/usr/bin/env bash
# tests/acceptance/ground.sh [--quick]: what makes the ground firm, one line each:
#   NAME VALUE BOUND ok|short          exit 0 only if none is short
# --quick: hard cases but the long ones, restart points, hashes over threads, the referee, refusals. Otherwise also the long
# hard cases, kills and injected faults, full disks, a sample of 60 mutants (MUTANTS=N: N), coverage, and the paper-size example
# (reused from build/acceptance/ when finished).
set -euo pipefail

# shellcheck source=tests/acceptance/setup.sh
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" "$@"

# Runs one of tests/survival or tests/cli; its log is kept.
shell_test() { # folder/script VARIABLE=value...
  local name=${1#*/}
  env GRAINLAW_SOURCE_DIR="$PWD" GRAINLAW_BUILD_DIR="$PWD/${bin%/bin}" "${@:2}" tests/in_fresh_directory.sh "$PWD/tests/$1.sh" "$PWD/$bin/grainlaw" \
    2>"$out/$name.log" >"$out/$name.txt" || tail -3 "$out/$name.log" >&2
}

refusals() {
  shell_test cli/refusals
  figure refusals.slowest_seconds "$(value_of refusals.slowest_seconds "$out/refusals.txt")" "<=0.1"
}

mishaps() {
  shell_test survival/kills KILLS=200
  figure kills.survived "$(value_of kills.survived "$out/kills.txt")" ">=200"
  shell_test survival/faults FAULTS=500
  local injected sound
  injected=$(value_of faults.injected "$out/faults.txt")
  sound=$(value_of faults.sound "$out/faults.txt")
  figure faults.injected "$injected" ">=500"
  figure faults.corrupt "$(awk -v i="$injected" -v s="$sound" 'BEGIN { print i == "missing" ? i : i - s }')" "<=0"
  shell_test survival/every_fault POINTS=10500
  local points
  points=$(value_of every_fault.all "$out/every_fault.txt")
  sound=$(value_of every_fault.all_sound "$out/every_fault.txt")
  figure every_fault.all "$points" ">=10000"
  figure every_fault.unsound "$(awk -v i="$points" -v s="$sound" 'BEGIN { print i == "missing" ? i : i - s }')" "<=0"
  shell_test survival/chain_kills KILLS=1000
  figure chain_kills.sound "$(value_of chain_kills.sound "$out/chain_kills.txt")" ">=1000"
  shell_test survival/full_disk
  figure disks.full "$(value_of disks.full "$out/full_disk.txt")" ">=3"
  shell_test survival/signals SIGNALS=24 PAPER_SIZE=yes
  figure signals.interrupted "$(value_of signals.interrupted "$out/signals.txt")" ">=12"
  figure signals.slowest_exit_seconds "$(value_of signals.slowest_exit_seconds "$out/signals.txt")" "<=2"
}

# Forces and short paths beside LAMMPS; its bounds are the test's own.
referee() {
  if ! command -v lmp >/dev/null; then
    figure LAMMPS missing stated
    return
  fi
  figures_of_tests $bin/referee '*' LAMMPS.force_error LAMMPS.P_star LAMMPS.C_star
}

mutants() {
  tests/mutants/run.sh --sample "${MUTANTS:-60}" >"$out/mutants.txt" 2>"$out/mutants.log" || tail -3 "$out/mutants.log" >&2
  local caught sown
  caught=$(awk '$1 == "mutants.caught" { print $2 }' "$out/mutants.txt")
  sown=$(awk '$1 == "mutants.caught" { print $4 }' "$out/mutants.txt")
  figure mutants.sown "${sown:-missing}" ">=40"
  figure mutants.caught_percent "$(awk -v c="${caught:-x}" -v s="${sown:-0}" 'BEGIN { print (s > 0 ? 100 * c / s : "missing") }')" ">=95"
}

coverage() {
  tests/coverage.sh >"$out/coverage.txt" 2>"$out/coverage.log" || tail -3 "$out/coverage.log" >&2
  figure coverage.lines "$(value_of coverage.lines "$out/coverage.txt")" ">=90"
}

paper_size() {
  local folder=$out/paper-size
  if [[ ! -s $folder/report.html ]]; then examples/paper-size/run.sh "$folder" >"$out/paper-size.txt"; fi
  local calibration=$folder/calibration.json
  figure paper_size.C_star.error "$(curve_error "$calibration" C_star 0.70 0.82)" "<=0.02"
  figure paper_size.P_star.error "$(curve_error "$calibration" P_star 0.72 0.82)" "<=0.04"
  figure paper_size.P_star.error.at_0.70 "$(curve_error "$calibration" P_star 0.70 0.70)" "<=0.08"
  figure paper_size.seconds "$(sed -n 's/^Whole chain after the build: \([0-9]*\) s.*/\1/p' "$out/paper-size.txt")" stated
}

hard_cases DORF
figure restart_points.bitwise "$(value_of R5.restart_points "$out/hard_cases.figures")" ">=100"
referee
refusals
if [[ $quick == no ]]; then
  mishaps
  paper_size
  coverage
  mutants
fi
finish_figures
