#!/usr/bin/env bash
# examples/studies/run.sh [OUT]: are the program's defaults on the edge of what a cost can buy? Error against cost of the
# engine's settings, of what is left out of a fit, and of the chain up to a prediction; one table each, and OUT/*/settings.svg.
# Installs what is missing, builds Release, writes to OUT (./grainlaw-studies). Finished simulations in OUT are reused.
set -euo pipefail

inputs=$(realpath "$(dirname "${BASH_SOURCE[0]}")")
out=$(realpath -m "${1:-grainlaw-studies}")
# shellcheck source=examples/chain.sh
. "$inputs/../chain.sh"
build_grainlaw
grainlaw=build/release/bin/grainlaw

$grainlaw study dem "$inputs/dem.json" -o "$out/dem" --reference time_step_fraction=0.05 strain_rate=69 \
  --vary time_step_fraction=0.2 time_step_fraction=0.14 strain_rate=276 strain_rate=552 precision=double rows=100 \
  quasi_static_step=0.004
$grainlaw study dem "$inputs/rate.json" -o "$out/rate" --reference time_step_fraction=0.05 strain_rate=69 \
  --vary strain_rate=276 strain_rate=552 strain_rate=1104
half=$(seq -s, 32)
$grainlaw study chain "$inputs/chain.json" -o "$out/chain" --for "$inputs/uniaxial.json" --reference strain_rate=69 \
  --vary "seeds=[$half]" particles=500 time_step_fraction=0.2 strain_rate=276 rows=100 'densities=[0.70,0.75,0.80]' 'tests[1].strain=0.2'
$grainlaw study fit "$out/chain/data/reference" -o "$out/fit" --for "$inputs/uniaxial.json"
