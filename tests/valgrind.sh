#!/usr/bin/env bash
# tests/valgrind.sh [PROGRAM[:FILTER]...]: unit tests of build/assertions, which must be built, under valgrind's memcheck; without
# names those of model, fit and predict, and those of dem but the slowest.
# One line each, "valgrind: PROGRAM ... ok|FAILED"; logs are left in build/valgrind. Exit code 1 if a test fails, memory is read
# before it is written or out of bounds, or a block is lost.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
programs=("$@")
if ((${#programs[@]} == 0)); then
  programs=("unit_fit:Calibrate.*" "unit_fit:-Calibrate.*" unit_model unit_predict  # two halves of an hour
            "unit_dem:-Runs.*:LaneList*:PathProbes*:ElasticModuli*:Preparation.*")
fi
mkdir -p build/valgrind

# The state of a lock's thread is known to that thread's stack alone, which a process forked meanwhile has not. Boost's stepper, the tests'
# yardstick, compares its first step with a last one that there was not, and begins anew either way.
cat >build/valgrind/suppressions <<'END'
{
  thread_of_a_lock_after_a_fork
  Memcheck:Leak
  match-leak-kinds: definite
  fun:_Znwm
  ...
  fun:_ZN8grainlaw11ProcessLock8try_lock*
}
{
  first_step_of_a_bulirsch_stoer
  Memcheck:Cond
  fun:*bulirsch_stoer*try_step*
}
END

# As it loads Highway's library reads a clock by rdtscp, which valgrind holds for no instruction where the processor does not
# announce it. The engine asks the library only for the instruction set, of which these builds have one.
if ! grep -qw rdtscp /proc/cpuinfo; then
  printf '%s\n' '#include <hwy/targets.h>' 'namespace hwy {' 'int64_t SupportedTargets() { return HWY_AVX2; }' \
    'void SetSupportedTargetsForTest(int64_t) {}' \
    'ChosenTarget& GetChosenTarget() { static ChosenTarget chosen; return chosen; }' '}  // namespace hwy' |
    g++ -std=c++20 -shared -fPIC -Wl,-soname,libhwy.so.1,--version-script,<(echo 'HWY_0 { global: *; };') -x c++ - \
      -o build/valgrind/libhwy.so.1
  export LD_LIBRARY_PATH=$PWD/build/valgrind${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
fi

check() { # PROGRAM[:FILTER]
  local program=${1%%:*} filter='*' begin=$SECONDS verdict=ok log
  [[ $1 == *:* ]] && filter=${1#*:}
  log=build/valgrind/$(tr -c '[:alnum:]_\n' - <<<"$1").log
  valgrind --quiet --error-exitcode=99 --leak-check=full --show-leak-kinds=definite --errors-for-leak-kinds=definite \
    --num-callers=20 --child-silent-after-fork=yes --suppressions=build/valgrind/suppressions \
    "build/assertions/bin/$program" --gtest_filter="$filter" >"$log" 2>&1 || verdict=FAILED
  count() { grep -c "$@" "$log" || true; }
  [[ $(count '^\[       OK \]') != 0 ]] || verdict=FAILED
  printf 'valgrind: %s, %s tests passed, %s skipped, %s failed, %s errors, %d s: %s\n' "$program" \
    "$(count '^\[       OK \]')" "$(count '^\[  SKIPPED \] .* ms')" "$(count '^\[  FAILED  \] .* ms')" \
    "$(count -E '^==[0-9]+== (Invalid|Conditional|Use of|Syscall|Mismatched|Source|[0-9,]+ .*definitely)')" \
    $((SECONDS - begin)) $verdict
  [[ $verdict == ok ]]
}
export -f check
# shellcheck disable=SC2016
printf '%s\n' "${programs[@]}" | xargs -P "$(nproc)" -I{} bash -c 'set -euo pipefail; check "$1"' check {} || exit 1
