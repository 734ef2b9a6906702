#!/usr/bin/env bash
# examples/paper/refit.sh [OUT]: law, predictions and report from the shipped data (examples/paper/data), in seconds and
# without simulating. Installs what is missing, builds Release, writes to OUT (./grainlaw-paper-refit).
set -euo pipefail

here=$(realpath "$(dirname "${BASH_SOURCE[0]}")")
out=$(realpath -m "${1:-grainlaw-paper-refit}")
# shellcheck source=examples/chain.sh
. "$here/../chain.sh"
build_grainlaw
grainlaw=build/release/bin/grainlaw

begin=$EPOCHREALTIME
$grainlaw calibrate --dataset "$here/data/dataset" -o "$out"
for path in "$here"/uniaxial-*.json; do
  name=$(basename "$path" .json)
  $grainlaw predict "$out/parameters.json" "$path" --against "$here/data/$name" -o "$out/predictions/$name"
done
$grainlaw report "$out" -o "$out/report.html" >/dev/null
awk -v a="$begin" -v b="$EPOCHREALTIME" 'BEGIN { printf "\nLaw, predictions and report: %.1f s\n", b - a }'
