#!/usr/bin/env bash
# tests/acceptance/pipeline.sh [--quick]: the figures that the whole chain must show, one line each:
#   NAME VALUE BOUND ok|short          exit 0 only if none is short
# --quick: hard cases only. Otherwise also the quickstart and the modes of driving (both reused from build/acceptance/ when
# finished), and the cost of the chain.
set -euo pipefail

# shellcheck source=tests/acceptance/setup.sh
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" "$@"

hard_cases() {
  figures_of_tests $bin/verification_dem '*.D1RestitutionOf*:*.D3*' D1.max D1.rms D1.mean D1.small D3
  figures_of_tests $bin/verification_dem '*.D6*/Paper:*.D7*/Paper:*.D8*/Paper:*.D11*' D6 D7.random D7.relaxed D8 D11.sc D11.bcc D11.fcc
  figures_of_tests $bin/verification_dem '*.D9Uniaxial*' D9
  figures_of_tests $bin/verification_predict '*.O1*:*.O6*' O1.adams O1.bdf O6.adams O6.bdf
  figures_of_tests $bin/verification_fit '*F5*' F5
  figures_of_tests $bin/unit_app '*F12*' F12
  if command -v lmp >/dev/null; then
    figures_of_tests $bin/referee '*' LAMMPS.force_error LAMMPS.stress_error LAMMPS.fabric_error LAMMPS.P_star LAMMPS.C_star LAMMPS.s_par
  fi
}

quickstart() {
  local out=$out/quickstart cost=$out/quickstart.cost
  if [[ ! -s $out/report.html || ! -s $cost ]]; then
    rm -rf "$out"
    /usr/bin/time --quiet --format '%e %M' --output "$cost.new" examples/quickstart/run.sh "$out" >&2
    mv "$cost.new" "$cost"
  fi
  local calibration=$out/calibration.json
  figure C_star.error "$(curve_error "$calibration" C_star 0.70 0.82)" "<=0.02"
  figure P_star.error "$(curve_error "$calibration" P_star 0.72 0.82)" "<=0.04"
  figure P_star.error.at_0.70 "$(curve_error "$calibration" P_star 0.70 0.70)" "<=0.08"
  figure stress_ratio_max.error "$(curve_error "$calibration" stress_ratio_max 0.68 0.82)" "<=0.10"
  figure fabric_max.error "$(curve_error "$calibration" fabric_max 0.68 0.82)" "<=0.15"
  local folder
  for folder in "$out"/predictions/*/; do
    jq -r --arg name "$(basename "$folder")" '.comparisons[] | select(.seed == null) as $c
      | $c.quantities[] | "\($name).\($c.model)-\($c.initial).\(.quantity).normalised_rms \(.normalised_rms)",
                          "\($name).\($c.model)-\($c.initial).\(.quantity).bias \(.bias)"' "$folder/comparison.json" |
      while read -r name value; do printf '%s %s\n' "$name" "$value"; done
  done >build/acceptance/predictions.txt
  while read -r name value; do figure "$name" "$value" stated; done <build/acceptance/predictions.txt
  figure_of_time chain "$(cut -d' ' -f1 "$cost")" "<=3000"
  figure chain.memory_MB "$(awk '{ print $2 / 1024 }' "$cost")" "<=1024"
}

hard_cases
if [[ $quick == no ]]; then
  quickstart
  tests/acceptance/driving_modes.sh "$bin/grainlaw" "$out/driving_modes" >"$out/driving_modes.txt"
  while read -r name value; do figure "driving.$name" "$value" stated; done <build/acceptance/driving_modes.txt
fi
finish_figures
