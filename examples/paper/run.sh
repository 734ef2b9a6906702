#!/usr/bin/env bash
# examples/paper/run.sh [OUT]: all data of the paper at its own size, with five packings: preparation, element tests, law,
# new packings for the uniaxial predictions, report. Installs what is missing, builds Release, writes to OUT
# (./grainlaw-paper). Half an hour to an hour on 2 cores; finished simulations in OUT are reused,
# interrupted ones go on.
set -euo pipefail

here=$(dirname "${BASH_SOURCE[0]}")
# shellcheck source=examples/chain.sh
. "$here/../chain.sh"
out=$(realpath -m "${1:-grainlaw-paper}")
inputs=$(realpath "$here")
run_chain "$here" "$out" --dem
# the same cycle at the tenth of the rate, for the energy ratio (Fig. 3)
build/release/bin/grainlaw simulate "$inputs/slow/cycle.json" -o "$out/slow-cycle" >/dev/null
