#!/usr/bin/env bash
# examples/quickstart/run.sh [OUT]: grains -> law -> predictions beside new grains -> report.
# Installs what is missing, builds Release, writes everything to OUT (./grainlaw-quickstart).
# Finished simulations in OUT are reused: a second run takes seconds.
set -euo pipefail

out=$(realpath -m "${1:-grainlaw-quickstart}")
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

./install-packages.sh
cmake --preset release --log-level=WARNING
cmake --build build/release --target grainlaw --parallel "$(nproc)"

mkdir -p "$out"
cost=$(mktemp)
trap 'rm -f "$cost"' EXIT

# Runs grainlaw and notes its seconds and peak memory in kB.
grainlaw() {
  echo "== grainlaw $*" >&2
  command time --quiet --append --output "$cost" --format '%e %M' build/release/bin/grainlaw "$@"
}

inputs=examples/quickstart
grainlaw calibrate "$inputs/spec.json" -o "$out"
for path in "$inputs"/uniaxial-*.json; do
  grainlaw predict "$out/parameters.json" "$path" --dem -o "$out/predictions/$(basename "$path" .json)"
done
summary=$(grainlaw report "$out" -o "$out/report.html")

awk '{ seconds += $1; if ($2 > peak) peak = $2 }
     END { printf "\nWhole chain after the build: %.0f s, peak memory %.0f MB\n\n", seconds, peak / 1024 }' "$cost"
printf '%s\n' "$summary"
