# Sourced by the acceptance scripts as `. setup.sh "$@"`: reads their one option, builds Release as a user would, and defines
#   quick (yes or no), bin (the executables), out (build/acceptance), and the functions of figures.sh and below.

script=$(realpath "$0")
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
# shellcheck source=tests/acceptance/figures.sh
. tests/acceptance/figures.sh
quick=no
case $#:${1:-} in
  0:) ;;
  1:--quick) quick=yes ;;
  *) awk 'NR > 1 { if (!sub(/^# /, "")) exit; print }' "$script" >&2; exit 2 ;;
esac

./install-packages.sh >&2
cmake --preset release --log-level=WARNING -DGRAINLAW_LONG=ON >&2
cmake --build build/release --parallel "$(nproc)" >&2
bin=build/release/bin
out=$PWD/build/acceptance
mkdir -p "$out"

# Wall time of a command [s].
seconds_of() { local TIMEFORMAT=%R; { time "$@" >/dev/null 2>&1; } 2>&1; }

# Runs one of tests/survival or tests/cli; its log is kept.
shell_test() { # folder/script VARIABLE=value...
  local name=${1#*/}
  env GRAINLAW_SOURCE_DIR="$PWD" GRAINLAW_BUILD_DIR="$PWD/build/release" "${@:2}" tests/in_fresh_directory.sh "$PWD/tests/$1.sh" "$PWD/$bin/grainlaw" \
    2>"$out/$name.log" >"$out/$name.txt" || tail -3 "$out/$name.log" >&2
}

# Runs tests of an executable by their gtest filter; exit code 0 if all passed. Those of `long`, hours in all, are taken from the log
# of the stage long (ctest --verbose) where tests/full.sh names it in LONG_LOG.
tests_by_filter() { # executable filter
  if [[ ${1##*/} != long || -z ${LONG_LOG:-} ]]; then
    "$1" --gtest_filter="$2" 2>&1
    return
  fi
  pattern=$(sed 's/[.]/[.]/g; s/[*]/.*/g; s/:/|/g' <<<"$2") awk '
    BEGIN { pattern = "^long[.](" ENVIRON["pattern"] ")$" }
    $1 == "Start" && $2 ~ /^[0-9]+:$/ { chosen[$2] = $3 ~ pattern; tests += chosen[$2] }
    chosen[$1] && sub(/^[0-9]+: /, "") { print }
    $2 == "Test" && chosen[substr($3, 2)] && /\*\*\*/ {
      failed++
      if (!/\*\*\*Failed/) printf "[  FAILED  ] %s (without an end, 0 ms)\nfigure %s.without_an_end 1 0\n", $4, $4
    }
    END { exit !tests || failed > 0 }' "$LONG_LOG"
}

# Runs the lines of hard_cases.txt whose id begins with one of the letters (long ones not with --quick); a line is passed
# when all its tests ran and passed. Figures: those of the tests, and hard_cases.listed, hard_cases.passed.
hard_cases() { # letters
  local id executable filter listed=0 passed=0 log figures=$out/hard_cases.figures
  : >"$figures"
  while read -r id executable filter; do
    [[ $id == ["$1"]* ]] || continue
    filter=${filter//\'/}
    [[ $quick == yes && $executable == long ]] && continue
    listed=$((listed + 1))
    if log=$(tests_by_filter "$bin/$executable" "$filter") && grep -q '^\[  PASSED  \] [1-9]' <<<"$log" &&
       ! grep -q '^\[  SKIPPED \]' <<<"$log"; then
      passed=$((passed + 1))
    else
      figure "hard_case.$id" failed stated
    fi
    grep -E '^figure( [^ ]+){3}$' <<<"$log" >>"$figures" || true
    grep '^count ' <<<"$log" | sed 's/^count //' >>"$figures" || true
  done < <(grep -v '^#' tests/acceptance/hard_cases.txt)
  while read -r _ name value bound; do figure "$name" "$value" "<=$bound"; done \
    < <(grep -E '^figure( [^ ]+){3}$' "$figures" | sort -u -k2,2)
  figure hard_cases.listed "$listed" stated
  figure hard_cases.passed "$passed" ">=$listed"
}
