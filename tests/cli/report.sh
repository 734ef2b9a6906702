#!/usr/bin/env bash
# `grainlaw report` on a folder that is not complete: exit 2, one line that names the file and the command that makes
# it, nothing written.
set -uo pipefail
grainlaw=$1
failed=0

# expect NAME FOLDER TEXT...: the refusal mentions every TEXT.
expect() {
  local name=$1 folder=$2
  shift 2
  "$grainlaw" report "$folder" -o page.html >out.txt 2>err.txt
  local code=$?
  if [[ $code -ne 2 ]]; then echo "$name: exit code $code instead of 2"; failed=1; fi
  if [[ $(wc -l <err.txt) -ne 1 ]]; then echo "$name: not one line:"; cat err.txt; failed=1; fi
  if [[ -s out.txt || -e page.html ]]; then echo "$name: something was written"; failed=1; fi
  local text
  for text in "$@"; do
    if ! grep -qF -- "$text" err.txt; then echo "$name: '$text' not in: $(cat err.txt)"; failed=1; fi
  done
}

expect "no folder" nowhere "nowhere/dataset/dataset.json" "grainlaw calibrate SPEC.json -o nowhere"

mkdir -p half/dataset
echo '{"format": "grainlaw dataset"}' >half/dataset/dataset.json
expect "no parameters" half "half/parameters.json" "grainlaw calibrate SPEC.json -o half"

echo '{}' >half/parameters.json
expect "no calibration" half "half/calibration.json" "grainlaw calibrate SPEC.json -o half"

echo '[[[' >half/calibration.json
expect "parameters of nothing" half "half/parameters.json" "grainlaw calibrate"

if "$grainlaw" report half >out.txt 2>err.txt; then echo "a report without -o was accepted"; failed=1; fi

exit $failed
