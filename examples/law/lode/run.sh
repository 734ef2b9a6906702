#!/usr/bin/env bash
# examples/law/lode/run.sh [OUT]: steady stress ratio, fabric and pressure of D3 and of D3 backwards over those of D2, packing by
# packing: mean and standard error. Installs what is missing, builds Release, writes to OUT (./grainlaw-lode); a quarter of an
# hour on one core. Finished simulations in OUT are reused.
set -euo pipefail

inputs=$(realpath "$(dirname "${BASH_SOURCE[0]}")")
out=$(realpath -m "${1:-grainlaw-lode}")
# shellcheck source=examples/chain.sh
. "$inputs/../../chain.sh"
build_grainlaw
build/release/bin/grainlaw calibrate "$inputs/spec.json" -o "$out" >/dev/null

# Means over shear_path >= .13 of one series.
steady() { # csv
  awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
           $column["shear_path"] >= 0.13 { s += $column["s_par"]; F += $column["F_par"]; P += $column["P_star"]; rows++ }
           END { print s / rows, F / rows, P / rows }' "$1"
}

echo "mode nu s_par F_par P_star (each over that of D2, mean +- standard error)"
for mode in D3 D3-reversed; do
  for nu in 0.70 0.74 0.78 0.82; do
    for seed in 31 32 33 34; do
      echo "$(steady "$out/dataset/$mode-$nu-s$seed.csv") $(steady "$out/dataset/D2-$nu-s$seed.csv")"
    done | awk -v mode="$mode" -v nu="$nu" '
      { for (q = 1; q <= 3; q++) { ratio = $q / $(q + 3); sum[q] += ratio; squares[q] += ratio * ratio } }
      END { printf "%s %s", mode, nu
            for (q = 1; q <= 3; q++) {
              mean = sum[q] / NR
              printf "  %.3f +- %.3f", mean, sqrt((squares[q] - NR * mean * mean) / (NR - 1) / NR) }
            print "" }'
  done
done
