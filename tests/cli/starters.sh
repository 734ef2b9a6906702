# grainlaw init: every starter runs, the SPEC at a higher rate; grainlaw check and --dry-run: what files are, whether they are sound, what they
# would run. No number here is of a machine: times are only asked to be there.
set -euo pipefail
grainlaw=$1 source=$GRAINLAW_SOURCE_DIR
fail() { echo "FAIL: $*" >&2; exit 1; }
fits() { (( $(LC_ALL=C.UTF-8 wc -L <"$1") <= 80 )); }

for kind in spec test path dataset; do "$grainlaw" init $kind >said || fail "init $kind"; done
grep -q 'next: grainlaw check dataset' said || fail "$(cat said)"
code=0
"$grainlaw" init spec 2>err || code=$?
[[ $code == 2 ]] && grep -q 'spec.json: is there already' err || fail "overwrites: $code $(cat err)"
mkdir partial; echo mine >partial/$(ls dataset | grep csv | tail -1); before=$(ls partial)
code=0
"$grainlaw" init dataset -o partial 2>err || code=$?
[[ $code == 2 && $(ls partial) == "$before" ]] && grep -q 'is there already' err || fail "half a data set: $code $(ls partial) $(cat err)"
"$grainlaw" init path -o other.json >/dev/null && cmp -s path.json other.json || fail "-o"
for file in spec.json test.json path.json; do grep -q '^ *//' $file || fail "no comments in $file"; done
jq -e '.comment | length > 5' dataset/dataset.json >/dev/null || fail "no comment of the data set"
# the schema that an editor is told of is there
for file in spec.json test.json path.json dataset/dataset.json; do
  url=$(sed -n 's/.*"$schema": "file:\/\/\(.*\)",/\1/p' "$file")
  [[ -s $url ]] && grep -q 'draft-07' "$url" || fail "$file: \$schema $url"
done

# sound, and nothing is run or written
"$grainlaw" check spec.json test.json path.json dataset >text || fail "$(cat text)"
[[ ! -e out ]] || fail "check writes"
for line in 'spec.json: SPEC, sound' 'test.json: TEST, sound' 'path.json: PATH, sound' 'dataset: data set, sound'; do
  grep -qx "$line" text || fail "$line: $(cat text)"
done
fits text || fail "wider than 80 columns"
"$grainlaw" check spec.json --json >check.json
jq -e '.[0] | .sound and .kind == "SPEC" and .forecast.runs == 24 and .forecast.runs_found == 0
       and .forecast.covers.nu_min == 0.66 and .forecast.covers.eps_dev > 0.259 and .forecast.run_seconds > 0
       and .forecast.bytes > 1e6' check.json >/dev/null || fail "$(cat check.json)"

# they run, the SPEC four times as fast (docs/tutorial.md runs it as it is); --dry-run before says what is then done, and finds it
# afterwards
sed -i 's/"strain_rate": 276,/"strain_rate": 1104,/' spec.json
"$grainlaw" calibrate spec.json -o out --dry-run --json >dry.json
[[ ! -e out ]] || fail "--dry-run writes"
"$grainlaw" calibrate spec.json -o out --json --quiet >calibrated.json || fail "the spec does not run"
jq -e --slurpfile dry dry.json '.runs == $dry[0].runs and .converged' calibrated.json >/dev/null || fail "$(cat calibrated.json)"
as_large() { # EXPECTED FOLDER...
  awk -v expected="$1" -v real="$(du -sb "${@:2}" | awk '{ s += $1 } END { print s }')" \
    'BEGIN { exit !(real < 1.3 * expected && expected < 1.3 * real) }' || fail "disk: $1 expected: $(du -sb "${@:2}")"
}
as_large "$(jq .bytes dry.json)" out/runs out/dataset
"$grainlaw" calibrate spec.json -o out --dry-run --json | jq -e '.runs_found == .runs and .particle_steps == 0' >/dev/null ||
  fail "finished runs are not found"
"$grainlaw" predict out/parameters.json path.json -o out/predictions/mine --dem --dry-run --json >dry.json
jq -e '.runs == 4' dry.json >/dev/null && [[ ! -e out/predictions ]] || fail "$(cat dry.json)"
echo '{"particles": 500, "keep": [{"nu": 0.7}]}' >keep.json
"$grainlaw" check keep.json >text || fail "a TEST is taken for a SPEC: $(cat text)"
refused_dry() { # words of the refusal, options...: by a dry run as by the command
  "$grainlaw" predict out/parameters.json "${@:2}" -o none --dry-run >text 2>log && fail "dry run of ${*:2}: $(cat text)"
  grep -q -- "$1" log || fail "dry run of ${*:2}: $(cat log)"
}
refused_dry 'nowhere' path.json --against nowhere
refused_dry 'measured starts from' path.json --initial measured
echo '{"initial": {"nu": 0.6}, "segments": [{"mode": "D2", "extent": {"eps_dev": 0.1}}]}' >low.json
refused_dry 'not jammed' low.json
"$grainlaw" check low.json out/parameters.json >text 2>log && fail "check takes what predict refuses: $(cat text)"
"$grainlaw" predict out/parameters.json path.json -o out/predictions/mine --dem --seeds 11-12 --quiet >text || fail "the path"
fits text || fail "predict is wider than 80 columns: $(cat text)"
jq -e '.seeds == [11, 12]' out/predictions/mine/dem/dataset.json >/dev/null || fail "seeds as a range"
"$grainlaw" calibrate --dataset dataset -o given >text 2>log || fail "the data set: $(cat log)"
fits text || fail "calibrate is wider than 80 columns"
"$grainlaw" simulate test.json -o tested --dry-run | grep -q '^  runs *2, of which 0' || fail "simulate --dry-run"
"$grainlaw" simulate test.json -o tested --dry-run --json >dry.json
"$grainlaw" simulate test.json -o tested --quiet >/dev/null || fail "the test"
as_large "$(jq .bytes dry.json)" tested
"$grainlaw" report out -o report.html >/dev/null || fail "report"

# whatever the program reads or has written
"$grainlaw" check out given/parameters.json tested/end.state tested/end.csv tested/series.csv given/dataset/dataset.json \
  "$source/fit/packing_prior.json" >text || fail "$(cat text)"
for line in 'out: calibration' 'given/parameters.json: parameters' 'tested/end.state: state' 'tested/end.csv: spheres' \
  'tested/series.csv: series' 'given/dataset/dataset.json: data set' "$source/fit/packing_prior.json: prior"; do
  grep -qx "$line, sound" text || fail "$line: $(cat text)"
done
# all that is shipped
mapfile -t shipped < <(cd "$source" && find examples -name '*.json' -not -path '*/dataset*/*' -not -path 'examples/paper/data/*' \
  -not -path 'examples/studies/*' -not -path examples/import/yade/mapping.json)  # of data that element_tests.py makes first
for file in "${shipped[@]}"; do "$grainlaw" check "$source/$file" --threads 1 >/dev/null 2>err || fail "$file: $(cat err)"; done
(( ${#shipped[@]} > 20 )) || fail "${#shipped[@]} examples"

# a SPEC that no law can be fitted to is one for the engine alone
"$grainlaw" check "$source/examples/law/cycles/spec.json" | tr -s '\n ' ' ' | grep -q 'calibrate refuses it: .*none of role calibration' || fail cycles

# beyond the calibrated range
echo '{"initial": {"nu": 0.728}, "segments": [{"mode": "D2", "extent": {"eps_dev": 0.9}}]}' >far.json
"$grainlaw" check out/parameters.json far.json | grep -q 'deviatoric strain 0.9 lies beyond the calibrated 0.26' || fail far

# a law is judged neither by another material nor by packings that it was fitted to under another SPEC
jq '.size_width = 1' out/spec.resolved.json >narrow.json
jq '.seeds = [101]' out/spec.resolved.json >reseeded.json
refused() { # word command...
  code=0
  "$grainlaw" "${@:2}" >/dev/null 2>err || code=$?
  [[ $code == 2 && ! -e judged ]] && grep -q "$1" err || fail "${*:2}: $code $(cat err)"
}
refused 'SPEC of new runs: size_width of its packing: 1, but 3 in test' check out/parameters.json narrow.json path.json
refused 'SPEC of new runs: size_width of its packing: 1, but 3 in test' predict out/parameters.json path.json -o judged --dem --spec narrow.json
refused 'seeds: 1 was used for the calibration' predict out/parameters.json path.json -o judged --dem --seeds 1 --spec reseeded.json

# all refusals of all files, exit code 2
echo '{"particle": 5, "seed": 1, "tests": [{"mode": "D4"}]}' >bad.json
echo '{"initial": {"nu": 0.7}, "segments": [{"mode": "D2", "extent": {"eps_vol": 0.1}}]}' >bad_path.json
head -c 100 tested/end.state >bad.state
code=0
"$grainlaw" check bad.json spec.json bad_path.json bad.state none.json >text 2>err || code=$?
[[ $code == 2 ]] && grep -qx 'spec.json: SPEC, sound' text || fail "refusals: $code $(cat text)"
for line in "bad.json: unknown key 'particle'; did you mean 'particles'?" "bad.json: unknown key 'seed'; did you mean 'seeds'?" \
  'bad.json: tests\[0\].mode: got "D4"' "bad.json: tests\[0\]: misses the key 'role'" \
  'bad_path.json: segments\[0\].extent: eps_vol cannot be reached' 'bad.state: ' 'none.json: cannot be opened'; do
  grep -q "^grainlaw: $line" err || fail "not said: $line: $(cat err)"
done
