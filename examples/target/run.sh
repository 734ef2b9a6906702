#!/usr/bin/env bash
# examples/target/run.sh ERROR [OUT [OPTION...]]: calibrates until the uniaxial compression beside this file is known to ERROR,
# e.g. 0.05, by the cheapest plan; then, once, compares with packings that no plan saw: four of spec.json, at its size and
# rate. Prints the wanted, the stated and the really reached error. Options go to calibrate, e.g. --quantity P_star --max-cost 600.
# Everything goes to OUT (./grainlaw-target-ERROR).
set -euo pipefail

error=${1:?usage: run.sh ERROR [OUT [OPTION...]]}
here=$(realpath "$(dirname "${BASH_SOURCE[0]}")")
out=$(realpath -m "${2:-grainlaw-target-$error}")
shift $(($# < 2 ? $# : 2))
# shellcheck source=examples/chain.sh
. "$here/../chain.sh"
build_grainlaw

build/release/bin/grainlaw calibrate "$here/spec.json" -o "$out" --target-error "$error" --for "$here/uniaxial-0.695.json" "$@" ||
  [[ $? == 3 ]] # what was not reached is shown below
model=$(jq -r '.rounds[-1].model' "$out/plan.json")
held=$out/predictions/uniaxial-0.695
build/release/bin/grainlaw predict "$out/parameters.json" "$here/uniaxial-0.695.json" -o "$held" \
  --spec "$here/spec.json" --dem --initial law --model "$model" >"$out/held-out.txt"

# Root mean square over the path of the mean over the packings of DEM - law, over the largest |mean DEM|; and what it would be by the
# packings' chance alone, their standard error.
reached() {
  local quantity=$1 seed files=()
  for seed in $(jq -r '.seeds[]' "$here/uniaxial-0.695.json"); do
    files+=("$held/dem/UNI-0.695-s$seed.csv" "$held/$model-law-s$seed.csv")
  done
  awk -F, -v quantity="$quantity" '
    FNR == 1 { delete column; for (i = 1; i <= NF; ++i) column[$i] = i; ++file; next }
    file % 2 == 1 { dem[FNR] = $(column[quantity]); shear[FNR] = $(column["shear_path"]) }
    file % 2 == 0 && shear[FNR] >= 0.01 {
      d = dem[FNR] - $(column[quantity]); sum[FNR] += d; squares[FNR] += d * d; level[FNR] += dem[FNR]
    }
    END {
      n = file / 2
      for (row in sum) {
        mean = sum[row] / n; variance = (squares[row] - n * mean * mean) / (n - 1) / n
        total += mean * mean; chance += variance; ++rows
        value = level[row] / n; if (value < 0) value = -value
        if (value > largest) largest = value
      }
      printf "%.2f %.2f", 100 * sqrt(total / rows) / largest, 100 * sqrt(chance / rows) / largest
    }' "${files[@]}"
}

printf '\n%-8s %8s %8s %14s %13s %9s   %s\n' quantity wanted stated 'really reached' 'by chance' seconds outcome
seconds=$(jq '[.rounds[].seconds] | add' "$out/plan.json")
jq -r '.outcome as $o | .rounds[-1].quantities[] | [.quantity, 100 * .error, $o] | @tsv' "$out/plan.json" |
  while IFS=$'\t' read -r quantity stated outcome; do
    read -r off chance < <(reached "$quantity"; echo)
    printf '%-8s %7.2f%% %7.2f%% %13.2f%% %12.2f%% %9.1f   %s\n' "$quantity" \
      "$(jq -n "100 * $error")" "$stated" "$off" "$chance" "$seconds" "$outcome"
  done
