#!/usr/bin/env bash
# examples/paper-size/run.sh [OUT]: packings of the paper's size at the paper's rate -> law -> report, then our curves
# beside the published ones. Two minutes on 2 cores.
# Installs what is missing, builds Release, writes everything to OUT (./grainlaw-paper-size).
# Finished simulations in OUT are reused: a second run takes seconds.
set -euo pipefail

here=$(dirname "${BASH_SOURCE[0]}")
# shellcheck source=examples/chain.sh
. "$here/../chain.sh"
out=$(realpath -m "${1:-grainlaw-paper-size}")
# Without D2-ISO the coupling of Eq. (16) is not identified: only the reduced law can predict.
run_chain "$here" "$out" --model reduced

# Curves of ISO unloading from nu = 0.68 on, those of D2 at the densities that were sheared.
jq -r '(.shear | map(.nu * 1e6 | round / 1e6) | unique) as $sheared
  | "quantity\tnu\tours\tpublished\tdifference",
    (.curves[] | .nu as $nu
     | select(if .quantity | test("^(stress|fabric|steady)") then any($sheared[]; . - $nu | fabs < 1e-6) else $nu >= 0.68 - 1e-9 end)
     | [.quantity, $nu, (.ours // "not identified"), .published,
        (if .ours then (.ours / .published - 1) * 1000 | round / 10 | tostring + " %" else "" end)] | @tsv)' \
  "$out/calibration.json" |
  awk -F '\t' 'function text(x) { return x ~ /^[-0-9.e]+$/ ? sprintf("%.4g", x) : x }
    NR == 1 { print "" } { printf "%-28s %-5s %-15s %-10s %s\n", $1, text($2), text($3), text($4), $5 }'
