#!/usr/bin/env bash
# examples/conserved/run.sh [OUT [--small]]: what the engine has to conserve, over 10^9 particle-steps: ten thousand spheres without
# background drag, sheared to and fro; their energy, momentum, volume and identity at 121 states on the way, in mixed and in double
# precision and at half the time step. Some minutes on two cores; --small: a thousand spheres, seconds. Writes OUT/conserved.csv and
# OUT/conserved.svg, prints lines "NAME NUMBER". Needs numpy and matplotlib. GRAINLAW: the program (build/release/bin/grainlaw).
set -euo pipefail
here=$(realpath "$(dirname "${BASH_SOURCE[0]}")")
grainlaw=$(realpath "${GRAINLAW:-$here/../../build/release/bin/grainlaw}")
out=$(realpath -m "${1:-grainlaw-conserved}")
spheres=10000
[[ ${2:-} != --small ]] || spheres=1000
mkdir -p "$out"

# A packing at a volume fraction of 0.74; then five cycles of pure shear of +-0.02.
echo "{\"particles\": $spheres, \"seed\": 1, \"strain_rate\": 276, \"rows\": 10, \"nu_end\": 0.73, \"background_viscosity\": 0, \"keep\": [{\"nu\": 0.74}]}" >"$out/packing.json"
"$grainlaw" simulate "$out/packing.json" -o "$out/packing" >/dev/null
for run in mixed:0.1 double:0.1 double:0.05; do
  folder=$out/${run/:/-}
  jq -n --arg state "$out/packing/unloading-0.74.state" --arg precision "${run%:*}" --argjson step "${run#*:}" '{state: $state, precision: $precision,
    time_step_fraction: $step, strain_rate: 276, rows: 20, frames: 8, segments: [{mode: "D2", cycles: {amplitude: 0.02, count: 5}}]}' >"$folder.json"
  "$grainlaw" simulate "$folder.json" -o "$folder" >/dev/null
  for state in "$folder"/frame-*.state; do "$grainlaw" export "$state" --format npz -o "$folder/states" --quiet >/dev/null; done
done
/usr/bin/python3 "$here/conserved.py" "$out"
