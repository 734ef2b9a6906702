# calibrate --target-error: packings are added until the band is narrow enough, or the time is up; rounds are kept.
set -euo pipefail
grainlaw=$1
fail() { echo "FAIL: $*" >&2; exit 1; }
echo '{"particles": 300, "seeds": [1, 2], "strain_rate": 3000, "rows": 40, "nu_end": 0.67, "densities": [0.70, 0.74, 0.79]}' >spec.json
echo '{"initial": {"nu": 0.72}, "segments": [{"mode": "D2", "extent": {"eps_dev": 0.2}}]}' >path.json

# three packings first, then at most three times as many, until the band is as narrow as wanted
"$grainlaw" calibrate spec.json -o loose --target-error 0.9 --for path.json --threads 2 >text 2>log || fail "loose: $(tail -1 log)"
jq -e '.outcome == "met" and .rounds[0].packings == 3 and .rounds[-1].half_width <= 0.9 and all(.rounds[:-1][]; .half_width > 0.9)
  and ([.rounds[].packings] | . as $n | all(range(1; length); $n[.] > $n[. - 1] and $n[.] <= 3 * $n[. - 1]))' loose/plan.json >/dev/null ||
  fail "$(cat loose/plan.json)"
[[ -s loose/parameters.json ]] && grep -q 'wanted 90.00 %: met' text || fail "$(cat text)"
[[ $(jq '.seeds | length' loose/spec.resolved.json) == $(jq '.rounds[-1].packings' loose/plan.json) ]] || fail seeds

# no time for more than the first round
code=0
"$grainlaw" calibrate spec.json -o tight --target-error 0.0001 --for path.json --max-cost 0.001 --threads 2 --json >json 2>log || code=$?
[[ $code == 3 ]] || fail "exit $code: $(tail -1 log)"
jq -e '.outcome != "met" and (.rounds | length) == 1' json >/dev/null || fail "$(cat json)"

for bad in '--target-error 0.1' '--for path.json' '--target-error 0 --for path.json' '--target-error 0.1 --for path.json --dataset loose'; do
  code=0
  # shellcheck disable=SC2086 # several words
  "$grainlaw" calibrate spec.json -o bad $bad >/dev/null 2>err || code=$?
  [[ $code == 2 && ! -e bad ]] || fail "$bad: exit $code, $(cat err)"
done
