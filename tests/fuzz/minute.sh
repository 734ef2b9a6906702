# minute.sh GRAINLAW FUZZ_READERS: every reader of foreign bytes on mutated files for a little while, without libFuzzer.
set -euo pipefail
scene=$(mktemp -d -p "$([[ -w /dev/shm ]] && echo /dev/shm || echo .)")
trap 'rm -rf "$scene"' EXIT
bash "$(dirname "${BASH_SOURCE[0]}")/scene.sh" "$1" "$scene"
"$2" "$scene" "${GRAINLAW_FUZZ_SECONDS:-20}" || { for f in finding-*; do base64 "$f" | head -40; done; exit 1; }
