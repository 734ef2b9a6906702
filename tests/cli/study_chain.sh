# study chain and study fit: settings of the whole chain and of a fit, against a reference; whether the default is dominated.
set -euo pipefail
grainlaw=$1
fail() { echo "FAIL: $*" >&2; exit 1; }
cat >spec.json <<'JSON'
{"particles": 1000, "seeds": [1, 2], "strain_rate": 1000, "rows": 40, "nu_end": 0.67, "densities": [0.70, 0.73, 0.76, 0.80],
 "tests": [{"mode": "ISO", "role": "calibration"}, {"mode": "D2", "role": "calibration"}, {"mode": "UNI", "role": "validation"}]}
JSON
echo '{"initial": {"nu": 0.72}, "segments": [{"mode": "D2", "extent": {"eps_dev": 0.2}}]}' >path.json

# a reference with more packings; too few densities for a law; a change that is none is the base again
"$grainlaw" study chain spec.json --for path.json --reference 'seeds=[1,2,3]' --vary 'densities=[0.70,0.80]' rows=40 \
  -o chain --threads 2 --json >stdout 2>stderr || fail "study chain: $(tail -1 stderr)"
cmp -s stdout chain/study.json || fail 'standard output is not the file'
jq -e '[.settings[].setting] == ["reference", "base", "densities=[0.70,0.80]", "rows=40"] and .study == "chain"
  and .reference == "reference" and .default.setting == "base" and .default.dominated_by == .settings[1].dominated_by' \
  chain/study.json >/dev/null || fail settings
jq -e '[.settings[].packings] == [3, 2, 2, 2] and .settings[1].changes == {} and .settings[2].changes == {"densities": [0.70, 0.80]}' \
  chain/study.json >/dev/null || fail packings
jq -e '.settings[0].error == 0 and .settings[0].floor == 0 and .settings[1].same_packings and .settings[1].error < 1e-9 and .settings[1].floor < 1e-9
  and ([.settings[0, 1, 3] | .energy_residual > 0 and .energy_residual < 0.01] | all)
  and ([.settings[0, 1, 3] | .reached >= .sampling and .sampling > 0 and .model == "reduced"] | all)' chain/study.json >/dev/null || fail errors
jq -e '[.settings[3], .settings[1] | {error, floor, sampling, particle_steps}] | .[0] == .[1]' chain/study.json >/dev/null ||
  fail 'no change made a difference'
jq -e '.settings[2] | .reached == null and .model == null and (.note | contains("at least 3 densities")) and .dominated == false' \
  chain/study.json >/dev/null || fail 'two densities make a law'
# costs: three packings against two, two densities against four; UNI is of no use to the fit and was not run
jq -e '(.settings | map(.particle_steps)) as $c | $c[0] > 1.4 * $c[1] and $c[2] < 0.6 * $c[1]' \
  chain/study.json >/dev/null || fail "costs: $(jq -c '[.settings[].particle_steps]' chain/study.json)"
! ls chain/data/base | grep -q UNI || fail 'a validation test was run'
jq -e '[.settings[1].quantities[] | select(.in_error) | .quantity] == ["P_star", "s_par", "F_par"]
  and ([.settings[1].quantities[].quantity] | contains(["s_max@0.76", "nu_c"]))' chain/study.json >/dev/null || fail quantities
grep -q 'base' chain/settings.svg || fail 'the figure lacks the base'
mv chain/study.json two.json
# again from the store, without a reference of its own
"$grainlaw" study chain spec.json --for path.json --vary 'seeds=[1,2,3]' -o chain --quiet >text || fail 'again'
(( $(LC_ALL=C.UTF-8 wc -L <text) <= 80 )) || fail "wider than 80 columns: $(cat text)"
grep -Eq '^base is (not )?dominated' text || fail "$(cat text)"
jq -e '.reference == "base" and .settings[0].error == 0 and .settings[0].reached == .settings[0].sampling
  and .settings[1].packings == 3' chain/study.json >/dev/null || fail 'base as reference'

# what the fit of all three packings loses with a part of the same data; two of them are the base of before, and lose nothing but
# certainty
"$grainlaw" study fit chain/data/reference -o fit --for path.json --vary rows_every=2 packings=2 shear_strain=0.75 --threads 2 --json \
  >stdout 2>stderr || fail "study fit: $(tail -1 stderr)"
cmp -s stdout fit/study.json || fail 'standard output is not the file'
jq -e '[.settings[].setting] == ["everything", "rows_every=2", "packings=2", "shear_strain=0.75"] and .study == "fit"
  and .default.setting == "everything" and .reference == "everything"' fit/study.json >/dev/null || fail 'settings of fit'
jq -e '.settings | .[0].error == 0 and .[1].error > 0 and .[1].particle_steps == .[0].particle_steps and .[2].packings == 2
  and .[2].particle_steps < 0.7 * .[0].particle_steps and .[3].particle_steps < .[0].particle_steps' fit/study.json >/dev/null || fail 'study fit'
same='{error, floor, sampling, reached, particle_steps}'
[[ $(jq -c ".settings[2] | $same" fit/study.json) == "$(jq -c ".settings[1] | $same" two.json)" ]] || fail 'packings=2 is another calibration'

for bad in 'seeds=[1]' 'densities=[0.7' 'tests[9].strain=0.1'; do
  code=0
  "$grainlaw" study chain spec.json --for path.json --vary "$bad" -o bad >/dev/null 2>err || code=$?
  [[ $code == 2 && ! -e bad ]] || fail "$bad: exit $code, $(cat err)"
done
for bad in 'packings=3' 'rows=2' 'loss=none'; do
  code=0
  "$grainlaw" study fit chain/data/base --vary "$bad" -o bad >/dev/null 2>err || code=$?
  [[ $code == 2 && ! -e bad ]] || fail "$bad: exit $code, $(cat err)"
done
