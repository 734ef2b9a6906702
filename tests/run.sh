#!/usr/bin/env bash
# tests/run.sh [--full [...]]: installs what is missing, builds Release, runs the tests.
#   --full [--plan | --again] [STAGE...]  the long tests, the other compiler, sanitizers, assertions, valgrind, the fuzzer and the
#                                         acceptance scripts, too: tests/full.sh, which says how far it is and resumes
# With CI=true in the environment warnings of the release build are errors. Exit code 0 only if everything passed.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
case $#:${1:-} in
  0:) ;;
  *:--full) exec tests/full.sh "${@:2}" ;;
  *) sed -n 's/^# //; 2,4p' "${BASH_SOURCE[0]}" >&2; exit 2 ;;
esac
jobs=$(nproc)
options=()
if [[ ${CI:-false} == true ]]; then
  options+=(-DGRAINLAW_WERROR=ON)
fi

./install-packages.sh
cmake --preset release --log-level=WARNING -DGRAINLAW_LONG=OFF "${options[@]}"
cmake --build build/release --parallel "$jobs"
# Three jobs a core: many tests wait for files or sleep. Hostile files take two minutes, their readers are under fuzz.minute, too.
exec ctest --preset release --parallel $((3 * jobs)) -E '^cli.hostile_files$'
