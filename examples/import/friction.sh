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

of_all() { # FILE: of each friction, as one array
  # shellcheck disable=SC2086
  jq -s . $(printf "$out/mu%s/$1 " $frictions)
}

echo "| equation | stage | quantity | misfit, mu = 0 | 0.1 | 0.5 | over that of mu = 0 | |"
echo "|---|---|---|---|---|---|---|---|"
of_all calibration.json | jq -r '
  def misfit($stage; $quantity): [.stages[] | select(.name == $stage) | .tests[] | select(.quantity == $quantity and .rows > 0)]
    | if length == 0 then null else ((map(.rms * .rms) | add / length | sqrt) / (map(.max_abs_data) | max)) end;
  def percent: if . == null then "–" else . * 10000 | round / 100 | tostring + " %" end;
  def times: if . == null then "–" else . * 10 | round / 10 | tostring end;
  . as $laws
  | ["11", "coordination", "C_star"], ["12", "rattlers", "rattler_fraction"], ["13", "overlap", "mean_overlap"],
    ["14", "pressure", "P_scaled"], ["tr F", "fabric_trace", "F_v"], ["11, steady", "steady_coordination", "C_star"],
    ["12, steady", "steady_rattlers", "rattler_fraction"], ["14, steady", "steady_pressure", "P_scaled"],
    ["17", "shear", "s_par"], ["18", "shear", "F_par"], ["20", "stress_ratio_max", "stress_ratio_max"],
    ["20", "stress_rate", "stress_rate"], ["20", "fabric_max", "fabric_max"], ["20", "fabric_rate", "fabric_rate"],
    ["16", "evolution", "s_par"], ["16", "evolution", "F_par"],
    ["memory", "memory", "P_star"], ["memory", "memory", "s_par"], ["memory", "memory", "F_par"]
  | . as [$equation, $stage, $quantity]
  | [$laws[] | misfit($stage; $quantity)] as $m
  | "| \($equation) | \($stage) | \($quantity) | \($m[0] | percent) | \($m[1] | percent) | \($m[2] | percent) | " +
    "\(if $m[0] and $m[1] then $m[1] / $m[0] else null end | times) | \(if $m[0] and $m[2] then $m[2] / $m[0] else null end | times) |"'

echo
echo "| parameter | mu = 0 | 0.1 | 0.5 |"
echo "|---|---|---|---|"
of_all parameters.json | jq -r '
  def digits: if . == null then "–" elif . == 0 then "0" else (. as $x | ($x | fabs | log10 | floor) as $e | ($x / pow(10; $e - 3) | round) * pow(10; $e - 3) * 1e9 | round / 1e9 | tostring) end;
  def shown: if . == null then "–" elif .status != "fitted" and .status != "tied" then .status
             else "\(.value | digits) ± \(.standard_error | if . == null then "?" else digits end)" end;
  [.[].parameters] as $laws
  | ($laws | map(keys_unsorted) | add | unique_by(.) | map(select(startswith("steady") | not)))[] as $name
  | "| `\($name)` | " + ([$laws[] | .[$name] | shown] | join(" | ")) + " |"'

echo
echo "| prediction | rung | P*: mu = 0 | 0.1 | 0.5 | s: mu = 0 | 0.1 | 0.5 | F: mu = 0 | 0.1 | 0.5 |"
echo "|---|---|---|---|---|---|---|---|---|---|---|"
for mu in $frictions; do
  jq -s --argjson mu "$mu" '{mu: $mu, runs: [.[].comparisons[] | select(.seed == null and .initial == "law")]}' "$out/mu$mu"/predictions/*/comparison.json
done | jq -rs '
  def error($rung; $quantity): [.runs[] | select(.model == $rung).quantities[] | select(.quantity == $quantity).normalised_rms | select(. != null)]
    | if length == 0 then "–" else (add / length * 1000 | round / 10 | tostring + " %") end;
  . as $all | ("reduced", "evolution", "memory") as $rung
  | "| uniaxial compression | \($rung) | " + ([("P_star", "s_par", "F_par") as $q | $all[] | error($rung; $q)] | join(" | ")) + " |"'

echo
echo "| friction | C0 | nu_c | misfit | C0 free | nu_c | misfit |"
echo "|---|---|---|---|---|---|---|"
for mu in $frictions; do echo "| $mu $(/usr/bin/python3 "$here/isostatic.py" "${iso_from[$mu]}" "$out/mu$mu/dataset")"; done
