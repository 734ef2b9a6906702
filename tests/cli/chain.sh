# The chain on small packings: calibrate -> again from the store -> from the data set -> predict with new DEM -> report.
set -euo pipefail
grainlaw=$1
fail() { echo "FAIL: $*" >&2; exit 1; }

cat >spec.json <<'JSON'
{"particles": 600, "seeds": [1, 2], "strain_rate": 2000, "rows": 60, "keep": [0.72], "densities": [0.70, 0.74, 0.78],
 "tests": [{"mode": "ISO", "role": "calibration"}, {"mode": "D2", "role": "calibration"}, {"mode": "D2-ISO", "role": "calibration"},
           {"mode": "UNI", "density": 0.70, "strain": 0.02, "role": "validation"}]}
JSON
echo '{"initial": {"nu": 0.72}, "segments": [{"mode": "UNI", "extent": {"target_nu": 0.80}}], "rows": 40}' >path.json

"$grainlaw" calibrate spec.json -o out --threads 2 >first.txt 2>log || fail "calibrate: $(tail -1 log)"
for file in spec.resolved.json parameters.json calibration.json fitted_paths.json dataset/dataset.json dataset/ISO-unloading-s1.csv dataset/D2-0.70-s2.csv; do
  [[ -s out/$file ]] || fail "no $file"
done
grep -q 'pressure.p0' first.txt || fail "no table on stdout"
grep -q $'\x1b' log && fail "escape sequences in a log"
head -1 out/dataset/D2-0.70-s1.csv | grep -q '^time\[s\],segment,strain_xx,' || fail "header"
grep -Eiq '(nan|inf)(,|$)' out/dataset/*.csv && fail "a non-finite number in a series"

# the packing of the middle density: sheared along the first axis and the last, contacts and forces follow
jq -e '.test == "D2-0.74-s1" and .horizontal == "x" and .vertical == "z" and (.before.circles | length) > 20 and (.after.chains | length) > 20
  and ([.before, .after | .count | length] == [18, 18]) and .after.width > .before.width * 1.1
  and ((.after.force | (.[8] + .[9]) / (.[0] + .[17])) > 1.2 * (.before.force | (.[8] + .[9]) / (.[0] + .[17])))' \
  out/dataset/pictures.json >/dev/null || fail "pictures.json: $(head -c 300 out/dataset/pictures.json)"
cp out/dataset/pictures.json pictures.json

# finished runs are found, one thread gives the same bits, and the resolved spec is a spec
"$grainlaw" calibrate out/spec.resolved.json -o out --threads 1 --json >second.json 2>log
grep -q '"runs_found": 16' second.json || fail "runs were repeated: $(cat second.json)"
digest() { grep -m1 '"digest"' "$1/dataset/dataset.json"; }
before=$(digest out)
"$grainlaw" calibrate spec.json -o single --threads 1 --quiet >/dev/null 2>log
[[ ! -s log ]] || fail "--quiet is not quiet: $(cat log)"
[[ $(digest single) == "$before" ]] || fail "results depend on the number of threads"

# without DEM, from the data set alone: the same parameters to the last digit
"$grainlaw" calibrate --dataset out/dataset -o refit --quiet >/dev/null
values() { sed '/"provenance"/,$d' "$1"; }
diff <(values out/parameters.json) <(values refit/parameters.json) || fail "refit differs"
[[ ! -e refit/runs ]] || fail "refit ran DEM"
cmp pictures.json out/dataset/pictures.json && cmp pictures.json single/dataset/pictures.json && cmp pictures.json refit/dataset/pictures.json ||
  fail "pictures differ: on one thread, from the store, or from the data set"
"$grainlaw" calibrate --dataset out -o refit --coupling single --starts 2 --quiet >/dev/null || [[ $? == 3 ]]
grep -q '"coupling": "single"' refit/parameters.json && grep -q '"tried": 2' refit/calibration.json || fail "coupling, starts"
"$grainlaw" calibrate --dataset out -o refit --loss huber --coupling single --quiet >/dev/null || [[ $? == 3 ]]
grep -q '"loss": "huber"' refit/calibration.json || fail "loss"
grep -q '"leave_one_out": null' refit/calibration.json || fail "checks that nobody asked for"

"$grainlaw" predict out/parameters.json path.json -o out/predictions/uni --dem --json >prediction.json 2>log || fail "predict: $(cat log)"
cd out/predictions/uni
for file in prediction.json comparison.json reduced-law.csv evolution-law.csv evolution-law-s3.csv reduced-measured-s4.csv dem/dataset.json dem/UNI-0.72-s3.csv; do
  [[ -s $file ]] || fail "no $file"
done
grep -q '"normalised_rms"' comparison.json && grep -q '"largest_at_nu"' comparison.json || fail comparison
grep -q '"rhs_evaluations"' prediction.json || fail "solver statistics"
grep -q 'P_star_mean95,P_star_single95' evolution-law.csv && [[ $(tail -n 1 evolution-law.csv) != *,,* ]] || fail "bands"
cd ../../..
jq -e '.rung.needed == "evolution" and (.rung.changes | length) > 0 and (.bands | startswith("95 %"))' prediction.json >/dev/null ||
  fail "rung and bands: $(cat prediction.json)"
jq -e '[.comparisons[] | .P_star.coverage_mean <= .P_star.coverage_single and .P_star.coverage_single <= 1] | all' prediction.json \
  >/dev/null || fail "coverage: $(cat prediction.json)"
code=0
"$grainlaw" predict out/parameters.json path.json -o out/predictions/bad --dem --seeds 2,9 2>err || code=$?
[[ $code == 2 ]] && grep -q 'seeds: 2 was used for the calibration' err && [[ ! -e out/predictions/bad ]] || fail "seeds of the calibration were accepted"
"$grainlaw" predict out/parameters.json path.json -o alone --model evolution >/dev/null
[[ -s alone/evolution-law.csv && ! -e alone/reduced-law.csv && ! -e alone/comparison.json ]] || fail "prediction alone"


# the same comparison with the finished runs alone, which may lie anywhere; runs of another path are refused
"$grainlaw" predict refit/parameters.json path.json -o again --against out/predictions/uni >/dev/null 2>log || fail "--against: $(cat log)"
"$grainlaw" predict out/parameters.json path.json -o same --against out/predictions/uni/dem >/dev/null
diff <(jq .comparisons same/comparison.json) <(jq .comparisons out/predictions/uni/comparison.json) || fail "--against differs from --dem"
[[ -s same/dem/UNI-0.72-s3.csv ]] || fail "no copy of the runs"
code=0
"$grainlaw" predict out/parameters.json path.json -o bad --against out 2>err || code=$?
[[ $code == 2 ]] && grep -q 'is of role calibration' err && [[ ! -e bad ]] || fail "calibration tests were compared with"
sed 's/{"mode": *"UNI"/{"rate_tensor": [[0,0,0],[0,0,0],[0,0,-1]]/' path.json >same.json
grep -q rate_tensor same.json && "$grainlaw" predict out/parameters.json same.json -o by-rate --against out/predictions/uni >/dev/null 2>log ||
  fail "--against the same path in other words: $(cat log)"
sed 's/0.80/0.79/' path.json >other.json
code=0
"$grainlaw" predict out/parameters.json other.json -o bad --against out/predictions/uni 2>err || code=$?
[[ $code == 2 ]] && grep -q 'follows another path' err && [[ ! -e bad ]] || fail "runs of another path were compared with"
mkdir renamed
jq '.tests |= map(select(.name == "D2-0.70-s2") | .name = "unseen" | .role = "validation") | del(.digest)' out/dataset/dataset.json >renamed/dataset.json
cp out/dataset/D2-0.70-s2.csv renamed/unseen.csv
jq '.tests[0].path | .segments |= map({mode, extent})' renamed/dataset.json >fitted.json
code=0
"$grainlaw" predict out/parameters.json fitted.json -o bad --against renamed 2>err || code=$?
[[ $code == 2 ]] && grep -q 'test unseen (validation) holds the series of test D2-0.70-s2, which is fitted' err && [[ ! -e bad ]] ||
  fail "a fitted run judged the law under another name: $(cat err)"

# parameters without errors, as older calibrations left them
jq 'del(.covariance, .scatter)' out/parameters.json >plain.json
"$grainlaw" predict plain.json path.json -o plain >text
grep -q '^bands     none: the parameters have no covariance' text && [[ $(tail -n 1 plain/evolution-law.csv) == *,,,,,,,,,, ]] ||
  fail "without covariance: $(cat text)"

# a path becomes a rehearsal: in parameters.json, beside the data set, and in the bands of other paths, not of its own
"$grainlaw" predict out/parameters.json path.json -o alone >text0
tr -s '\n ' ' ' <text0 | grep -q "the law's own error is not in them" || fail "silent about the law's own error: $(cat text0)"
jq -e '.rung.recommended == .rung.needed and (.rung.rehearsed | not) and .rehearsals == null' alone/prediction.json >/dev/null || fail "advice without rehearsals"
cp -r out rehearsed
"$grainlaw" predict rehearsed/parameters.json path.json -o rehearsed/uni --against out/predictions/uni --rehearse >/dev/null 2>log || fail "--rehearse: $(cat log)"
[[ -s rehearsed/dataset/rehearsals/uni/UNI-0.72-s3.csv ]] || fail "the runs were not kept"
jq -e '[.rehearsals[] | .name, .kind, .packings] == ["uni", "monotone", 2]' rehearsed/parameters.json >/dev/null || fail "no record"
jq -e '.rehearsals == null and (.bands | contains("not in them"))' rehearsed/uni/prediction.json >/dev/null || fail "a path spoke for itself"
"$grainlaw" predict rehearsed/parameters.json other.json -o rehearsed/other >text
grep -q '^rehearsed 1 path of all kinds, m = 1' text && jq -e '.rung.rehearsed and .rehearsals.paths == 1' rehearsed/other/prediction.json >/dev/null ||
  fail "a rehearsal does not speak for another path: $(cat text)"
width() { tail -n 1 "$1" | cut -d, -f 29; }  # P_star_mean95
"$grainlaw" predict out/parameters.json other.json -o other >/dev/null
awk -v a="$(width rehearsed/other/evolution-law.csv)" -v b="$(width other/evolution-law.csv)" 'BEGIN { exit !(a > b) }' || fail "the band did not grow"
# under another name it would count twice, and its name is taken
code=0
"$grainlaw" predict rehearsed/parameters.json path.json -o rehearsed/again --against out/predictions/uni --rehearse >/dev/null 2>err || code=$?
[[ $code == 2 && ! -e rehearsed/again ]] && grep -q "rehearsal 'again': its path is rehearsed as 'uni'" err || fail "a path rehearsed twice: $(cat err)"
code=0
"$grainlaw" predict rehearsed/parameters.json other.json -o new/uni --against out/predictions/uni --rehearse >/dev/null 2>err || code=$?
[[ $code == 2 ]] && grep -q "rehearsal 'uni': is another path of the law already" err || fail "two paths of one name: $(cat err)"
# predicted along another path, without runs, nothing of the earlier comparison stays
cp -r out/predictions/uni used
"$grainlaw" predict out/parameters.json other.json -o used --quiet >/dev/null
[[ ! -e used/comparison.json && -z $(find used -maxdepth 1 -name '*-s3.csv') ]] || fail "left: $(ls used)"
"$grainlaw" check out/dataset/D2-0.70-s1.csv >text; grep -q " $(($(wc -l <out/dataset/D2-0.70-s1.csv) - 1)) rows" text || fail "rows: $(cat text)"
"$grainlaw" check out >text; grep -q '[0-9] tests, [0-9]* prediction' text || fail "check of a folder: $(cat text)"
# refitted from the data set it is found again; a second path makes two, and each can be left out
"$grainlaw" calibrate --dataset rehearsed -o refitted --quiet >/dev/null
diff <(jq .rehearsals rehearsed/parameters.json) <(jq .rehearsals refitted/parameters.json) || fail "rehearsals got lost"
cp -r rehearsed cheated
cp -r renamed cheated/dataset/rehearsals/fitted
code=0
"$grainlaw" calibrate --dataset cheated -o bad --quiet 2>err || code=$?
[[ $code == 2 ]] && grep -q 'fitted: test unseen (validation) holds the series of test D2-0.70-s2' err && [[ ! -e bad ]] ||
  fail "a fitted run became a rehearsal: $(cat err)"
# fitted from other data, nothing of these stays
cp -r rehearsed used-law
"$grainlaw" calibrate --dataset "$GRAINLAW_SOURCE_DIR/examples/starters/dataset" -o used-law >/dev/null 2>err || [[ $? == 3 ]]
[[ ! -e used-law/spec.resolved.json && ! -e used-law/dataset/rehearsals/uni && -e used-law/dataset/rehearsals-of-before/uni ]] || fail "of other data: $(ls used-law used-law/dataset)"
grep -q 'put aside as' err || fail "silent: $(cat err)"
cmp <(cd used-law/dataset && ls -- *.csv) <(jq -r '.tests[].name + ".csv"' used-law/dataset/dataset.json | sort) || fail "series of other data"
# nor by one of another material, which a changed SPEC would leave in the folder: refused before anything runs
jq '.size_width = 2' out/spec.resolved.json >narrow.json
cp -r rehearsed before
for command in "calibrate narrow.json --quiet" "calibrate narrow.json --dry-run" "calibrate narrow.json --target-error 0.1 --for other.json" \
  "calibrate narrow.json --target-error 0.1 --for other.json --dry-run" "runs narrow.json --array 2"; do
  code=0
  # shellcheck disable=SC2086 # words
  "$grainlaw" $command -o rehearsed >/dev/null 2>err || code=$?
  [[ $code == 2 ]] && grep -q 'rehearsals/uni: test UNI-0.72-s3: size_width of its packing: 3, but 2 in SPEC' err && diff -r before rehearsed ||
    fail "$command, a rehearsal of another material: $(cat err)"
done
# spheres of one size stand beside the paper's numbers as such
cp -r out/dataset one-size
jq '(.. | objects | select(has("size_width")).size_width) = 1 | del(.digest)' out/dataset/dataset.json >one-size/dataset.json
for each in out one-size; do "$grainlaw" calibrate --dataset $each -o beside --quiet >$each.text || fail "$each"; done
grep -q '^published of another material: size_width of its packing: 1, but 3' one-size.text || fail "$(tail -4 one-size.text)"
! grep -q '^published of' out.text || fail "$(tail -4 out.text)"
"$grainlaw" predict refitted/parameters.json other.json -o refitted/predictions/other --dem --seeds 3 --spec out/spec.resolved.json --store out --rehearse >/dev/null 2>log ||
  fail "--dem --rehearse: $(cat log)"
"$grainlaw" study bands refitted -o bands >text || fail "study bands"
(( $(LC_ALL=C.UTF-8 wc -L <text) <= 80 )) || fail "study bands is wider than 80 columns: $(cat text)"
jq -e '(.summaries | length) >= 6 and .summaries[0].paths == 2 and all(.coverages[]; .bias_error > 0)' bands/study.json >/dev/null ||
  fail "study bands: $(cat text)"
code=0
"$grainlaw" predict out/parameters.json path.json -o bad --rehearse 2>err || code=$?
[[ $code == 2 && ! -e bad ]] || fail "--rehearse without runs"

touch .report.html.tmp-1-0 .mine.tmp-1-0  # of a report that was killed; of somebody else
"$grainlaw" report out -o report.html >table.txt
[[ ! -e .report.html.tmp-1-0 && -e .mine.tmp-1-0 ]] || fail "left of a killed report, or taken from others: $(ls -a)"
rm .mine.tmp-1-0
[[ -s report.html ]] && grep -q 'pressure.p0' table.txt || fail report
grep -q 'class="verdict' report.html && grep -q 'Distrust first' report.html || fail "what a reader sees first"
"$grainlaw" report refit -o refit.html --compare out >/dev/null
grep -q 'No path that the fit never saw has been predicted' refit.html && grep -q 'grainlaw predict refit/parameters.json' refit.html || fail "a page without predictions"
grep -q 'id="comparison"' refit.html || fail "report --compare"
find . -name '.*tmp*' | grep -q . && fail "temporary files left"
exit 0
