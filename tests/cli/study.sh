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
