#!/usr/bin/env bash
# run.sh [--seconds S | --runs N] [--fast] [--grainlaw FILE] [READER...]: the readers of foreign bytes under libFuzzer (clang 14)
# with the address and undefined-behaviour sanitizers, one after the other; all of them where none is named. Prints executions,
# rate, edges covered and findings of each. What a run learns (build/fuzz/corpus) the next one starts from; findings stay in
# build/fuzz/findings. A call may take 5 s and 1 GB. Exit code 1 with findings.
#   --fast  with the assertions of the C++ library only, several times as fast; what it learned then runs under the sanitizers
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
limit=-max_total_time=60 preset=fuzz grainlaw='' wanted=()
while (($#)); do
  case $1 in
    --seconds) limit=-max_total_time=$2; shift ;;
    --runs) limit=-runs=$2; shift ;;
    --fast) preset=fuzz-fast ;;
    --grainlaw) grainlaw=$2; shift ;;
    -*) sed -n 's/^# //; 2,6p' "${BASH_SOURCE[0]}" >&2; exit 2 ;;
    *) wanted+=("$1") ;;
  esac
  shift
done
command -v clang++-14 >/dev/null || { echo "tests/fuzz/run.sh: needs clang-14 and libclang-rt-14-dev (./install-packages.sh --full)" >&2; exit 2; }

for each in $(printf '%s\n' fuzz $preset | sort -u); do
  cmake --preset "$each" --log-level=WARNING
  cmake --build --preset "$each" --parallel "$(nproc)"
done
if [[ -z $grainlaw ]]; then
  cmake --build build/fuzz --parallel "$(nproc)" --target grainlaw
  grainlaw=build/fuzz/bin/grainlaw
fi
mkdir -p build/fuzz/findings
temporary=$(mktemp -d -p /dev/shm)
trap 'rm -rf "$temporary"' EXIT
# memory that is given back to the system, and kept from use for long, takes more than half of the time of so small calls
export ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=0:allocator_release_to_os_interval_ms=-1:quarantine_size_mb=4
export ASAN_OPTIONS+=:thread_local_quarantine_size_kb=64:malloc_context_size=4
export UBSAN_OPTIONS=print_stacktrace=1
tests/fuzz/scene.sh "$grainlaw" "$temporary/scene"
if ((${#wanted[@]} == 0)); then
  mapfile -t wanted < <(sed -n 's/^ *{"\([a-z_-]*\)", Shape.*/\1/p' tests/fuzz/readers_of_*.cpp)
fi

# -entropic=0: keeping account of how rare each edge is took 14 % of the time of so small calls
fuzz() { # BUILD_FOLDER argument...
  GRAINLAW_READER=$reader GRAINLAW_SCENE=$scene GRAINLAW_SEEDS=$scene/first "$1/bin/fuzz_readers" "${@:2}" -max_len=16384 -timeout=5 \
    -rss_limit_mb=1024 -malloc_limit_mb=512 -len_control=20 -entropic=0 -print_final_stats=1 -verbosity=1 \
    -artifact_prefix="build/fuzz/findings/$reader-"
}

new_scene() { rm -rf "$scene" && cp -r "$temporary/scene" "$scene" && mkdir "$scene/first"; }

printf '%-14s %12s %9s %7s %9s %8s\n' reader executions per-s edges seconds findings
status=0
for reader in "${wanted[@]}"; do
  scene=$temporary/$reader corpus=build/fuzz/corpus/$reader log=build/fuzz/findings/$reader.log
  new_scene
  mkdir -p "$corpus"
  rm -f "$log"*
  start=$SECONDS code=0
  fuzz build/$preset "$limit" "$corpus" "$scene/first" >"$log" 2>&1 || code=1
  if [[ $preset != fuzz ]]; then new_scene; fuzz build/fuzz -runs=0 "$corpus" >"$log.sanitizers" 2>&1 || code=1; fi
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  rate=$(sed -n 's/^stat::average_exec_per_sec: *//p' "$log")
  edges=$(grep -ao 'cov: [0-9]*' "$log" | tail -1 | cut -c 6-)
  printf '%-14s %12s %9s %7s %9s %8s\n' "$reader" "${executions:--}" "${rate:--}" "${edges:--}" $((SECONDS - start)) $code
  rm -rf "$scene"
  ((code == 0)) || { status=1; grep -a -m3 -E 'FINDING|ERROR|runtime error|SUMMARY' "$log"* >&2 || tail -5 "$log" >&2; }
done
exit $status
