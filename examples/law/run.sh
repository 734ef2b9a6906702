#!/usr/bin/env bash
# examples/law/run.sh [OUT]: the three rungs of the law on paths that the calibration never saw: uniaxial compression and
# unloading, D3, D2 then D3, cycles of D2. Everything goes to OUT (./grainlaw-law). About half an hour on 2 cores; finished
# simulations in OUT are reused.
set -euo pipefail

here=$(dirname "${BASH_SOURCE[0]}")
# shellcheck source=examples/chain.sh
. "$here/../chain.sh"
run_chain "$here" "${1:-grainlaw-law}" --dem
