#!/usr/bin/env bash
# examples/paper/pictures.sh [OUT]: simulates the first packing of spec.json once more, sheared at the middle density, and keeps how it
# looks before and after beside the shipped data (data/dataset/pictures.json), whose own states were not kept. Some minutes. Installs
# what is missing, builds Release, writes to OUT (./grainlaw-paper-pictures).
set -euo pipefail

here=$(realpath "$(dirname "${BASH_SOURCE[0]}")")
out=$(realpath -m "${1:-grainlaw-paper-pictures}")
# shellcheck source=examples/chain.sh
. "$here/../chain.sh"
build_grainlaw

mkdir -p "$out"
jq '.densities[.densities | length / 2 | floor] as $middle
  | .seeds = [.seeds[0]] | .densities = [$middle] | .keep = []
  | .tests = [.tests[] | select(.role == "calibration" and (.mode == "ISO" or .mode == "D2"))]' "$here/spec.json" >"$out/spec.json"
build/release/bin/grainlaw calibrate "$out/spec.json" -o "$out" || [[ $? == 3 ]] # one density is no calibration
jq -c --slurpfile data "$here/data/dataset/dataset.json" \
  '. + {note: "Simulated once more for the pictures, by engine version \($new) where the data are of version \($data[0].provenance.engine_version): the same spec and seed, another course of the same chaos."}' \
  --argjson new "$(jq .provenance.engine_version "$out/dataset/dataset.json")" "$out/dataset/pictures.json" \
  >"$here/data/dataset/pictures.json"
