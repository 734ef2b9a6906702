# examples/library against the installed package: it builds, and what it finds is what the program finds, digit for digit.
set -euo pipefail
grainlaw=$1
source=$GRAINLAW_SOURCE_DIR build=$GRAINLAW_BUILD_DIR
fail() { echo "FAIL: $*" >&2; exit 1; }
cached() { sed -n "s/^$1:[A-Z]*=//p" "$build/CMakeCache.txt"; }

lines=$(wc -l <"$source/examples/library/chain.cpp")
((lines <= 60)) || fail "the example has $lines lines: no page any more"
cmake --install "$build" --prefix "$PWD/prefix" >log || fail "$(cat log)"
cmake -S "$source/examples/library" -B example -G "$(cached CMAKE_GENERATOR)" \
  -D CMAKE_CXX_COMPILER="$(cached CMAKE_CXX_COMPILER)" -D CMAKE_BUILD_TYPE=Release \
  -D CMAKE_PREFIX_PATH="$PWD/prefix" >log 2>&1 || fail "$(cat log)"
cmake --build example >log 2>&1 || fail "$(cat log)"

cat >spec.json <<'JSON'
{"particles": 600, "seeds": [1, 2], "strain_rate": 2000, "rows": 60, "keep": [0.72], "densities": [0.70, 0.74, 0.78],
 "tests": [{"mode": "ISO", "role": "calibration"}, {"mode": "D2", "role": "calibration"}, {"mode": "D2-ISO", "role": "calibration"}]}
JSON
cat >path.json <<'JSON'
{"initial": {"nu": 0.72}, "segments": [{"mode": "UNI", "extent": {"eps_dev": 0.03}}], "rows": 40}
JSON
example/chain spec.json path.json by_library >library.txt || fail "the example ends with $?"
code=0
"$grainlaw" calibrate spec.json -o by_program --quiet >text || code=$?
((code == 0 || code == 3)) || fail "calibrate ends with $code"
"$grainlaw" predict by_program/parameters.json path.json --dem -o by_program/predictions/path --quiet >text ||
  fail "predict ends with $?"

# Everything but who made it, when and where.
numbers() { jq -S 'walk(if type == "object" then del(.provenance, .seconds, .cost, .command, .parameters.file?,
  .parameters.sha256?) else . end)' "$1"; }
for file in parameters.json predictions/path/comparison.json predictions/path/prediction.json; do
  numbers "by_library/$file" >of_library && numbers "by_program/$file" >of_program || fail "$file is no JSON"
  cmp of_library of_program || fail "$file differs"
done
for file in by_program/predictions/path/*.csv by_program/dataset/*.csv; do
  cmp "$file" "by_library/${file#by_program/}" || fail "${file#by_program/} differs"
done
# What it printed is what the files say.
printed() { awk -v name="$1" '$1 == name { print $2 }' library.txt; }
jq -e --argjson printed "$(printed evolution.law.P_star)" '[.comparisons[] | select(.seed == null and .model == "evolution"
  and .initial == "law") | .quantities[] | select(.quantity == "P_star") | .normalised_rms] == [$printed]' \
  by_program/predictions/path/comparison.json >/dev/null || fail "$(cat library.txt)"
[[ $(printed tests) == "$(jq '.tests | length' by_program/dataset/dataset.json)" ]] || fail "$(cat library.txt)"
[[ $(printed predictions) == 1 ]] || fail "$(cat library.txt)"

# A spec that is refused is an error that names the file.
echo '{"particles": -1}' >bad.json
! example/chain bad.json path.json refused 2>text || fail "a bad spec passes"
grep -q 'bad.json: particles' text || fail "$(cat text)"
