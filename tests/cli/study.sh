# study integrator: its files, the schema's keys, and errors that fall with the tolerance.
set -euo pipefail
grainlaw=$1
fail() { echo "FAIL: $*" >&2; exit 1; }
"$grainlaw" study integrator -o out --repeats 1 --paths 50 --threads 2 --json >stdout 2>stderr || fail "$(cat stderr)"
cmp -s stdout out/study.json || fail 'standard output is not the file'
jq -e '.format == "grainlaw study" and (.panels | length) == 3 and (.batch | length) >= 1' out/study.json >/dev/null || fail format
# every integrator follows its accuracy on every path: the finest point is 100 times better than the coarsest, at least
jq -e 'all(.panels[]; . as $panel | [.points[].integrator] | unique | all(. as $i |
  [$panel.points[] | select(.integrator == $i) | .error] | last * 100 <= first))' out/study.json >/dev/null || fail 'errors do not fall'
jq -e 'all(.panels[]; .reference_disagreement < 1e-10)' out/study.json >/dev/null || fail 'the references disagree'
jq -e 'all(.panels[].points[]; .rhs_evaluations > 0 and .microseconds > 0)' out/study.json >/dev/null || fail counts
head -c 200 out/work_precision.svg | grep -q '<svg xmlns="http://www.w3.org/2000/svg"' || fail 'no figure'
grep -q 'near-unjamming' out/work_precision.svg || fail 'the figure lacks a panel'

# study dem: the reference has no error against itself, a coarser step costs less, a change that is none is the base again
cat >spec.json <<'JSON'
{"particles": 300, "seeds": [1, 2], "strain_rate": 3000, "rows": 40, "nu_end": 0.67, "densities": [0.72, 0.78],
 "tests": [{"mode": "ISO", "role": "calibration"}, {"mode": "D2", "role": "calibration"}]}
JSON
"$grainlaw" study dem spec.json --reference time_step_fraction=0.06 --vary time_step_fraction=0.17 --vary strain_rate=3000 \
  -o dem --threads 2 --json >stdout 2>stderr || fail "study dem: $(tail -1 stderr)"
cmp -s stdout dem/study.json || fail 'standard output is not the file'
jq -e '[.settings[].setting] == ["reference", "base", "time_step_fraction=0.17", "strain_rate=3000"]' dem/study.json >/dev/null || fail settings
jq -e '.settings[0].error == 0 and all(.settings[1:][]; .error > 0 and .floor > 0)' dem/study.json >/dev/null || fail 'errors of the reference'
jq -e '.settings[2].particle_steps < 0.7 * .settings[1].particle_steps and .settings[1].particle_steps < 0.7 * .settings[0].particle_steps' \
  dem/study.json >/dev/null || fail costs
jq -e '.settings[3].error == .settings[1].error and .settings[3].particle_steps == .settings[1].particle_steps' dem/study.json >/dev/null ||
  fail 'no change made a difference'
jq -e '[.settings[1].quantities[].quantity] | length == 13 and contains(["beta_F@0.78", "nu_c"])' dem/study.json >/dev/null || fail quantities
jq -e '.default.setting == "base" and .default.dominated_by == .settings[1].dominated_by and .reference == "reference"
  and all(.settings[]; .packings == 2 and .model == null and .dominated == (.dominated_by | length > 0))' dem/study.json >/dev/null || fail verdict
grep -q 'time_step_fraction=0.17' dem/settings.svg || fail 'the figure lacks a setting'
for bad in 'time_step_fraction' 'no_such_key=1' 'time_step_fraction=9' 'seeds=7'; do
  code=0
  "$grainlaw" study dem spec.json --reference time_step_fraction=0.06 --vary "$bad" -o bad >/dev/null 2>err || code=$?
  [[ $code == 2 && ! -e bad ]] || fail "$bad: exit $code, $(cat err)"
done
