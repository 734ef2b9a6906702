#!/usr/bin/env bash
# tests/run.sh [--full]: installs what is missing, builds Release, runs the tests.
#   --full  adds the long tests, the other compiler, the sanitizer builds, the fuzzer and the acceptance scripts.
# With CI=true in the environment warnings of the release build are errors. Exit code 0 only if everything passed.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
full=no
case $#:${1:-} in
  0:) ;;
  1:--full) full=yes ;;
  *) sed -n 's/^# //; 2,4p' "${BASH_SOURCE[0]}" >&2; exit 2 ;;
esac
jobs=$(nproc)

build() { # preset option...
  cmake --preset "$1" --log-level=WARNING "${@:2}" &&
    cmake --build "build/$1" --parallel "$jobs"
}

options=()
if [[ ${CI:-false} == true ]]; then
  options+=(-DGRAINLAW_WERROR=ON)
fi

if [[ $full == no ]]; then
  ./install-packages.sh
  build release -DGRAINLAW_LONG=OFF "${options[@]}"
  exec ctest --preset release --parallel $((jobs + 1))  # a test waits for files and sleeps, too
fi
./install-packages.sh --full
build release -DGRAINLAW_LONG=ON "${options[@]}"

failed=()
ctest --test-dir build/release --output-on-failure --parallel "$jobs" || failed+=(release)
presets=(clang asan-ubsan tsan)
if ! command -v clang++-14 >/dev/null; then
  echo "tests/run.sh --full: without clang++-14, the preset clang is left out" >&2
  presets=("${presets[@]:1}")
fi
for preset in "${presets[@]}"; do
  { build "$preset" && ctest --preset "$preset" --parallel "$jobs"; } || failed+=("$preset")
done
if command -v clang++-14 >/dev/null; then
  tests/fuzz/run.sh --seconds 60 --grainlaw build/release/bin/grainlaw || failed+=(fuzz)
fi
for script in tests/acceptance/{pipeline,ground}.sh; do
  echo "== $script"
  bash "$script" || failed+=("$script")
done

if ((${#failed[@]})); then
  echo "tests/run.sh --full: failed: ${failed[*]}" >&2
  exit 1
fi
echo "tests/run.sh --full: everything passed" >&2
