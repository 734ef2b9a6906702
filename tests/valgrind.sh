#!/usr/bin/env bash
# tests/valgrind.sh [PROGRAM[:FILTER]...]: unit tests of build/assertions, which must be built, under valgrind's memcheck; without
# names those of model, fit and predict and those of dem that read and write files.
# One line each, "valgrind: PROGRAM ... ok|FAILED"; logs are left in build/valgrind. Exit code 1 if a test fails, memory is read
# before it is written or out of bounds, or a block is lost.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
programs=("$@")
if ((${#programs[@]} == 0)); then
  files='StateFile.*:SphereTable.*:ForeignFrame*:ParticleSeries*:Snapshot.*:SpecFile.*:DurableFile.*:LammpsDeck.*:RunLists.*'
  programs=(unit_model unit_fit unit_predict "unit_dem:$files")
fi
mkdir -p build/valgrind

check() { # PROGRAM[:FILTER]
  local program=${1%%:*} filter='*' begin=$SECONDS verdict=ok log
  [[ $1 == *:* ]] && filter=${1#*:}
  log=build/valgrind/$program.log
  valgrind --quiet --error-exitcode=99 --leak-check=full --show-leak-kinds=definite --errors-for-leak-kinds=definite \
    --num-callers=20 --child-silent-after-fork=yes \
    "build/assertions/bin/$program" --gtest_filter="$filter" >"$log" 2>&1 || verdict=FAILED
  count() { grep -c "$@" "$log" || true; }
  printf 'valgrind: %s, %s tests passed, %s skipped, %s failed, %s errors, %d s: %s\n' "$program" \
    "$(count '^\[       OK \]')" "$(count '^\[  SKIPPED \] .* ms')" "$(count '^\[  FAILED  \] .* ms')" \
    "$(count -E '^==[0-9]+== (Invalid|Conditional|Use of|Syscall|Mismatched|Source|[0-9,]+ .*definitely)')" \
    $((SECONDS - begin)) $verdict
  [[ $verdict == ok ]]
}
export -f check
# shellcheck disable=SC2016
printf '%s\n' "${programs[@]}" | xargs -P "$(nproc)" -I{} bash -c 'set -euo pipefail; check "$1"' check {}
