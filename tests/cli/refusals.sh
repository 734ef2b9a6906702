# Hard cases S1, S2, S6: refused with exit code 2 and one line naming file and key; no folder is left behind. How long the
# slowest refusal takes is only printed: tests/acceptance/ground.sh compares it with the 0.1 s of S2.
set -euo pipefail
grainlaw=$1
fail() { echo "FAIL: $*" >&2; exit 1; }
slowest=0

# refuse FILE EXPECTED COMMAND...
refuse() {
  local expected=$1 code=0
  shift
  TIMEFORMAT='%3U %3S'  # processor time: the wall clock also counts what else the machine does
  { time "$@" -o out >stdout 2>stderr || code=$?; } 2>times
  [[ $code == 2 ]] || fail "exit code $code, not 2: $* : $(head -c 300 stderr)"
  [[ ! -s stdout ]] || fail "wrote a result: $*"
  [[ $(wc -l <stderr) == 1 ]] || fail "not one line: $(head -c 600 stderr)"
  grep -Fq -- "$expected" stderr || fail "expected '$expected', got: $(cat stderr)"
  [[ ! -e out ]] || fail "left a folder behind: $*"
  slowest=$(awk -v s="$slowest" '{ t = $1 + $2; print (t > s ? t : s) }' times)
}
spec() { printf '%s' "$1" >spec.json; refuse "$2" "$grainlaw" calibrate spec.json; }

spec '{"particle": 10}' "spec.json: unknown key 'particle'; did you mean 'particles'?"
spec '{"particles": "many"}' 'spec.json: particles: got "many"; give an integer >= 1'
spec '{"particles": NaN}' 'spec.json: particles: '
spec '{"particles": 1e18}' 'spec.json: particles: got 1000000000000000000'
spec '{"particles": 1e309}' 'spec.json: particles: 1e309 is beyond the range of numbers'
spec '{"particles": -0}' 'spec.json: particles: negative zero'
spec '{"particles": 10, "particles": 20}' 'spec.json: particles: is given twice'
spec '{"mean_radius": -1e-3}' 'spec.json: mean_radius: got -0.001'
spec '{"densities": [0.95]}' 'spec.json: densities[0]: got 0.95'
spec '{"densities": [0.85]}' 'spec.json: densities or keep: 0.85 is not on the unloading branch'
spec '{"nu_max": 0.91}' 'spec.json: nu_max: got 0.91'
spec '{"time_step_fraction": 0}' 'spec.json: time_step_fraction: got 0'
spec '{"time_step_fraction": 0.7}' 'spec.json: time_step_fraction: got 0.7'
spec '{"strain_rate": 1e-6, "stiffness": 1e15}' 'spec.json: strain_rate: '
spec '{"tests": [{"mode": "D2", "role": "calibration", "name": "../../x"}]}' 'spec.json: tests[0].name: got "../../x"'
spec '{"tests": [{"mode": "D2", "role": "calibration", "name": "/tmp/x"}]}' 'spec.json: tests[0].name: '
spec '{"tests": [{"mode": "D2", "role": "calibration", "name": "a\nb"}]}' 'spec.json: tests[0].name: '
spec '{"tests": [{"mode": "D2", "role": "validation"}, {"mode": "ISO", "role": "calibration"}]}' 'none of role calibration is a shear'
spec "$(printf '\xef\xbb\xbf{}')" 'byte order mark'
spec "$(printf '{"comment": "\xff"}')" 'spec.json: comment: '
spec '' 'spec.json: '
spec '{' 'spec.json: '
head -c 500000 /dev/zero | tr '\0' '[' >spec.json
refuse 'nested deeper than' "$grainlaw" calibrate spec.json
for ((i = 0; i < 100000; ++i)); do printf '{"a":'; done >spec.json
refuse 'nested deeper than' "$grainlaw" calibrate spec.json
head -c 1000000 /dev/zero >spec.json
refuse 'spec.json: ' "$grainlaw" calibrate spec.json
refuse 'none.json: cannot be opened' "$grainlaw" calibrate none.json
refuse 'is a folder' "$grainlaw" calibrate .
refuse 'holds no dataset.json' "$grainlaw" calibrate --dataset .

echo '{"segments": [{"mode": "D2", "extent": {"eps_dev": 0.1}}]}' >test.json
refuse 'test.json: segments: start nowhere' "$grainlaw" simulate test.json
echo '{"initial": {"nu": 0.7}, "segments": [{"mode": "D2", "extent": {"eps_vol": 0.1}}]}' >test.json
refuse 'test.json: segments[0].extent: eps_vol cannot be reached' "$grainlaw" simulate test.json
echo '{"spheres": "s.csv", "cell": [[1,0,0],[0,1,0],[0,0,1]]}' >test.json
printf 'id,x,y,z,r\n0,0.1,0.1,0.1,-0.1\n' >s.csv
refuse 's.csv' "$grainlaw" simulate test.json
echo '{"initial": {"nu": 0.7}, "segments": [{"mode": "D2", "extent": {"eps_dev": 0.1}}]}' >path.json
echo '{}' >parameters.json
refuse "parameters.json: misses the key 'format'" "$grainlaw" predict parameters.json path.json
refuse 'none.json: cannot be opened' "$grainlaw" predict none.json path.json
echo "refusals.slowest_seconds $slowest"
