#!/usr/bin/env bash
# examples/quickstart/run.sh [OUT]: grains -> law -> predictions beside new grains -> report.
# Installs what is missing, builds Release, writes everything to OUT (./grainlaw-quickstart).
# Finished simulations in OUT are reused: a second run takes seconds.
set -euo pipefail

here=$(dirname "${BASH_SOURCE[0]}")
# shellcheck source=examples/chain.sh
. "$here/../chain.sh"
run_chain "$here" "${1:-grainlaw-quickstart}" --dem
