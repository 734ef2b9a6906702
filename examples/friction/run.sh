#!/usr/bin/env bash
# examples/friction/run.sh OUT [--small] [MU...]: what friction does to the law. For each mu (0, 0.01, 0.1, 0.5) packings are
# prepared and tested by LAMMPS, the law is calibrated to them and predicts uniaxial compression; prints the tables of
# docs/friction.md. Packings of 1000, 3 seeds (an hour on two cores); --small: of 500, 2 seeds, fast (some minutes).
# GRAINLAW names the program (default: that of build/release). Needs lmp, jq and scipy. The same call goes on where it was stopped.
set -euo pipefail
(($# >= 1)) || { sed -n '2,5s/^# //p' "$0" >&2; exit 2; }

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
grainlaw=${GRAINLAW:-$here/../../build/release/bin/grainlaw}
out=$1
shift
size='{"particles": 1000, "seeds": [1, 2, 3], "strain_rate": 276, "rows": 50}'
if [[ ${1:-} == --small ]]; then
  size='{"particles": 500, "seeds": [1, 2], "strain_rate": 1104, "time_step_fraction": 0.2, "rows": 40}'
  shift
fi
(($# > 0)) || set -- 0 0.01 0.1 0.5

for mu in "$@"; do
  # where the packing jams falls with friction: densities from a little above it, ISO fitted from there on
  read -r nu_start iso_from shear turning uniaxial < <(awk -v mu="$mu" 'BEGIN {
    if (mu < 0.005) print 0.64, 0.675, "[0.68,0.71,0.75,0.80]", "[0.71,0.75]", "0.70"
    else if (mu < 0.05) print 0.63, 0.665, "[0.67,0.70,0.75,0.80]", "[0.70,0.75]", "0.69"
    else if (mu < 0.3) print 0.60, 0.655, "[0.66,0.69,0.73,0.79]", "[0.69,0.73]", "0.68"
    else print 0.55, 0.605, "[0.62,0.66,0.71,0.78]", "[0.66,0.71]", "0.64" }')
  folder=$out/mu$mu
  mkdir -p "$folder"
  echo "$iso_from" >"$folder/iso_from"
  jq -n --argjson size "$size" --argjson mu "$mu" --argjson nu_start "$nu_start" --argjson shear "$shear" \
    --argjson turning "$turning" --argjson uniaxial "$uniaxial" '$size + {
      engine: "lammps", friction: $mu, driving: "constant", nu_start: $nu_start, nu_end: ($nu_start + 0.02), densities: $shear,
      keep: [$uniaxial],
      tests: [{mode: "ISO", role: "calibration"}, {mode: "D2", density: "all", strain: 0.26, role: "calibration"},
              {mode: "D2-ISO", density: $turning, strain: 0.15, role: "calibration"}]}' >"$folder/spec.json"
  jq -n --argjson nu "$uniaxial" '{initial: {nu: $nu}, segments: [{mode: "UNI", extent: {target_nu: 0.80}}]}' >"$folder/uniaxial.json"
  "$grainlaw" calibrate "$folder/spec.json" --iso-from "$iso_from" -o "$folder" >"$folder/law.txt" || (($? == 3))
  "$grainlaw" predict "$folder/parameters.json" "$folder/uniaxial.json" --dem -o "$folder/predictions/uniaxial" \
    >"$folder/uniaxial.txt" || (($? == 3))
done
"$here/tables.sh" "$out" "$@"
