#!/usr/bin/env bash
# examples/law/run.sh [OUT]: the three rungs of the law, calibrated on the shipped data of the paper's size (examples/paper/data),
# on paths that no fit saw: uniaxial compression and unloading, D2, D3, D2 then D3, cycles of D2, compression with shear, each on
# three to thirty new packings of that size. Installs what is missing, builds Release, writes to OUT (./grainlaw-law). An hour or more on
# 2 cores; finished simulations in OUT are reused, interrupted ones go on.
set -euo pipefail

inputs=$(realpath "$(dirname "${BASH_SOURCE[0]}")")
out=$(realpath -m "${1:-grainlaw-law}")
# shellcheck source=examples/chain.sh
. "$inputs/../chain.sh"
build_grainlaw
grainlaw=build/release/bin/grainlaw

$grainlaw calibrate --dataset "$inputs/../paper/data/dataset" -o "$out"
for path in "$inputs"/*.json "$inputs"/cycles/*.json; do
  if [[ $path == */spec.json ]]; then continue; fi
  $grainlaw predict "$out/parameters.json" "$path" --dem --spec "$(dirname "$path")/spec.json" -o "$out/predictions/$(basename "$path" .json)"
done
$grainlaw report "$out" -o "$out/report.html"
