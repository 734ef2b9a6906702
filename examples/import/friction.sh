#!/usr/bin/env bash
# examples/import/friction.sh OUT [DATA]: does the form of the law hold for spheres with friction?
# Imports the tests of LAMMPS in DATA (default: those shipped here), mu = 0, 0.1 and 0.5, calibrates the law to each, predicts
# uniaxial compression and prints tables of Markdown: misfits, parameters, errors of the predictions, and Eq. (11) with C0 free.
# GRAINLAW names the program (default: that of build/release). Needs jq and scipy. docs/friction.md says what they mean.
set -euo pipefail
(($# >= 1)) || { sed -n '2,5s/^# //p' "$0" >&2; exit 2; }

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
out=$1 data=${2:-$here/lammps/data}
grainlaw=${GRAINLAW:-$here/../../build/release/bin/grainlaw}
frictions="0 0.1 0.5"
declare -A iso_from=([0]=0.675 [0.1]=0.655 [0.5]=0.605)  # a little above jamming

for mu in $frictions; do
  folder=$out/mu$mu
  mkdir -p "$folder"
  echo "${iso_from[$mu]}" >"$folder/iso_from"
  "$grainlaw" import "$data/mu$mu/calibration.json" -o "$folder/dataset" --quiet >"$folder/import.txt"
  "$grainlaw" calibrate --dataset "$folder/dataset" --iso-from "${iso_from[$mu]}" -o "$folder" --quiet >"$folder/law.txt" || (($? == 3))
  for mapping in "$data/mu$mu"/uniaxial-*.json; do
    name=$(basename "$mapping" .json)
    "$grainlaw" import "$mapping" -o "$folder/$name" --quiet >/dev/null
    jq '.tests[0].path' "$mapping" >"$folder/$name.path.json"
    "$grainlaw" predict "$folder/parameters.json" "$folder/$name.path.json" --against "$folder/$name" \
      -o "$folder/predictions/$name" --quiet >/dev/null
  done
done

# shellcheck disable=SC2086  # a list
"$here/../friction/tables.sh" "$out" $frictions
