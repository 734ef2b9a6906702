#!/usr/bin/env bash
# tests/coverage.sh: which lines of the product code does the default suite reach?
# Prints "coverage.lines.ROOM PERCENT" for each room and "coverage.lines PERCENT" for all; build/coverage/coverage.txt
# has the same with every file and its missing lines. Exit code 0 if the suite passed and no count was lost.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
jobs=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}
folder=build/coverage
rooms=(model dem fit predict chain app)

./install-packages.sh --full >&2
cmake --preset coverage --log-level=WARNING >&2
cmake --build $folder --parallel "$jobs" >&2
find $folder -name '*.gcda' -delete  # counts of earlier runs
# A process that is killed while it writes its counts, or may not write so much, leaves them half written, and nothing is added
# to them after it: tests that do that to the program are left out, by name, as a label is left out only if the preset's is, too.
export GCOV_ERROR_FILE=$PWD/$folder/gcov_errors.txt
rm -f "$GCOV_ERROR_FILE"
ctest --preset coverage --parallel "$jobs" \
  --exclude-regex '^(survival\.|cli\.(hostile_files|interrupt|lammps|nothing_lost|tasks)$)' >&2
if [[ -s $GCOV_ERROR_FILE ]]; then
  echo "coverage: $(wc -l <"$GCOV_ERROR_FILE") counts were lost, see $GCOV_ERROR_FILE; the figures would be too low" >&2
  exit 1
fi

filters=()
for room in "${rooms[@]}"; do filters+=(--filter "$room/"); done
# threads count without waiting for each other, so that the count of a branch may end below zero: such lines are left out
gcovr --root . "${filters[@]}" --gcov-ignore-parse-errors $folder --txt $folder/files.txt --json-summary $folder/summary.json
for room in "${rooms[@]}" ''; do
  jq -r --arg room "$room" '[.files[] | select(.filename | startswith($room))]
    | "coverage.lines" + (if $room == "" then "" else "." + $room end) + " "
      + (100 * (map(.line_covered) | add) / (map(.line_total) | add) * 10 | round / 10 | tostring)' $folder/summary.json
done | tee $folder/coverage.txt
cat $folder/files.txt >>$folder/coverage.txt
