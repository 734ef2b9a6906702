#!/usr/bin/env bash
# examples/friction/tables.sh OUT MU...: tables of Markdown of the laws in OUT/muMU, one for each friction: misfits beside those of
# the first, parameters, errors of the predictions in OUT/muMU/predictions, and Eq. (11) with C0 free from OUT/muMU/iso_from on.
# Needs jq and scipy. docs/friction.md says what they mean.
set -euo pipefail
(($# >= 2)) || { sed -n '2,4s/^# //p' "$0" >&2; exit 2; }
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
out=$1
shift
heads=$(printf ' | %s' "$@")
rules=$(printf -- '---|%.0s' "$@")

of_all() { # FILE: of each friction, as one array
  local mu files=()
  for mu in "${frictions[@]}"; do files+=("$out/mu$mu/$1"); done
  jq -s . "${files[@]}"
}
frictions=("$@")

echo "| equation | stage | quantity$heads | over that of mu = $1 |"
echo "|---|---|---|$rules---|"
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
  | "| \($equation) | \($stage) | \($quantity) | " + ($m | map(percent) | join(" | ")) + " | " +
    ($m[1:] | map(if . and $m[0] then . / $m[0] else null end | times) | join(", ")) + " |"'

echo
echo "| parameter$heads |"
echo "|---|$rules"
of_all parameters.json | jq -r '
  def digits: if . == null then "–" elif . == 0 then "0" else (. as $x | ($x | fabs | log10 | floor) as $e | ($x / pow(10; $e - 3) | round) * pow(10; $e - 3) * 1e9 | round / 1e9 | tostring) end;
  def shown: if . == null then "–" elif .status != "fitted" and .status != "tied" then .status
             else "\(.value | digits) ± \(.standard_error | if . == null then "?" else digits end)" end;
  [.[].parameters] as $laws
  | ($laws | map(keys_unsorted) | add | unique_by(.) | map(select(startswith("steady") | not)))[] as $name
  | "| `\($name)` | " + ([$laws[] | .[$name] | shown] | join(" | ")) + " |"'

echo
echo "| uniaxial compression: rung | quantity$heads |"
echo "|---|---|$rules"
for mu in "${frictions[@]}"; do
  cat "$out/mu$mu"/predictions/*/comparison.json 2>/dev/null | jq -s '{runs: [.[].comparisons[] | select(.seed == null and .initial == "law")]}'
done | jq -rs '
  def error($rung; $quantity): [.runs[] | select(.model == $rung).quantities[] | select(.quantity == $quantity).normalised_rms | select(. != null)]
    | if length == 0 then "–" else (add / length * 1000 | round / 10 | tostring + " %") end;
  . as $all | ("reduced", "evolution", "memory") as $rung | ("P_star", "s_par", "F_par") as $q
  | "| \($rung) | \($q) | " + ([$all[] | error($rung; $q)] | join(" | ")) + " |"'

echo
echo "| friction | C0 | nu_c | misfit | C0 free | nu_c | misfit |"
echo "|---|---|---|---|---|---|---|"
for mu in "${frictions[@]}"; do
  echo "| $mu $(/usr/bin/python3 "$here/../import/isostatic.py" "$(cat "$out/mu$mu/iso_from")" "$out/mu$mu/dataset")"
done
