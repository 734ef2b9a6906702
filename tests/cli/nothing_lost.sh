# Nothing lost, nothing overwritten: special files stay what they are, a refusal changes no folder and leaves none, damaged runs are
# made again, a file beyond the shell's limit is an error with a message.
set -euo pipefail
grainlaw=$1
fail() { echo "FAIL: $*" >&2; exit 1; }
code_of() { local code=0; "$@" >out 2>err || code=$?; echo "$code"; }
shipped=$GRAINLAW_SOURCE_DIR/examples/starters/dataset

"$grainlaw" calibrate --dataset "$shipped" -o good --quiet >/dev/null
state_of() { (cd good && find . -type f -exec sha256sum {} + | sort); }

# devices, FIFOs, links, standard output
if mknod null c 1 3 2>/dev/null && : >null; then
  [[ $(code_of "$grainlaw" report good -o null) == 0 && -c null ]] || fail "a device was replaced: $(ls -l null) $(cat err)"
fi
mkfifo fifo
cat fifo >through &
[[ $(code_of "$grainlaw" report good -o fifo) == 0 && -p fifo ]] || fail "a FIFO was replaced"
wait
ln -s page.html link.html
[[ $(code_of "$grainlaw" report good -o link.html) == 0 && -L link.html ]] || fail "a link was replaced"
cmp -s page.html through || fail "the FIFO got something else than the link's target"
[[ $(code_of "$grainlaw" report good -o -) == 0 && ! -e ./- ]] && cmp -s out page.html || fail "-o - is not standard output"
[[ $(code_of "$grainlaw" report good -o - --json) == 2 ]] || fail "page and JSON on one output"
[[ $(code_of "$grainlaw" init spec -o -) == 0 && ! -e ./- ]] && cp out starter.json &&
  [[ $(code_of "$grainlaw" check starter.json) == 0 ]] || fail "init -o - $(cat out err)"

# a page in place of a result, also through a link; options that nothing reads
before=$(state_of)
ln -s good/parameters.json linked
for name in good/parameters.json good/dataset/dataset.json good/dataset/D2-0.68-s1.csv linked; do
  [[ $(code_of "$grainlaw" report good -o "$name") == 2 ]] && grep -q 'ends with .html' err || fail "report over $name: $(cat err)"
done
[[ $(state_of) == "$before" ]] || fail "report replaced a result"
echo '{"initial": {"nu": 0.72}, "segments": [{"mode": "D2", "extent": {"eps_dev": 0.05}}]}' >d2.json
for option in "--seeds 3" "--spec none.json" "--store none"; do
  [[ $(code_of "$grainlaw" predict good/parameters.json d2.json -o p $option) == 2 ]] && grep -q 'give --dem too' err ||
    fail "predict $option: $(cat err)"
done

# a data set that is refused, before the fit or by it, changes nothing
before=$(state_of)
cp -r "$shipped" bad
sed -i '5s/[0-9]/x/3' bad/D2-0.68-s1.csv
[[ $(code_of "$grainlaw" calibrate --dataset bad -o good) == 2 && $(state_of) == "$before" ]] || fail "unreadable: good was changed"
rm -rf bad && cp -r "$shipped" bad
jq '(.tests[] | select(.name | startswith("D2")) | .role) |= "validation" | del(.digest)' bad/dataset.json >t && mv t bad/dataset.json
[[ $(code_of "$grainlaw" calibrate --dataset bad -o good) == 2 && $(state_of) == "$before" ]] || fail "no shear: good was changed"
rm -rf bad && cp -r "$shipped" bad
cp bad/D2-0.68-s1.csv bad/D2-0.68-s2.csv
jq 'del(.digest, .tests[].sha256)' bad/dataset.json >t && mv t bad/dataset.json
[[ $(code_of "$grainlaw" calibrate --dataset bad -o good) == 2 && $(state_of) == "$before" ]] || fail "one series twice: good was changed, $(cat err)"
[[ $(code_of "$grainlaw" calibrate --dataset bad -o none) == 2 && ! -e none ]] || fail "a refused data set left a folder"
(: >file; [[ $(code_of "$grainlaw" calibrate --dataset "$shipped" -o file) == 2 && -f file ]]) || fail "a file as folder"

# runs: what is refused amid a run leaves no folder; a damaged record is put aside and the run made again
echo '{"particles": 64, "seed": 3, "strain_rate": 5000, "rows": 10, "nu_end": 0.72, "initial": {"nu": 0.74}, "segments": [{"mode": "D2", "extent": {"eps_dev": 0.02}}]}' >test.json
if [[ $(code_of "$grainlaw" simulate test.json -o sim) == 0 ]]; then
  run=$(ls -d sim/runs/*/ | head -1)
  jq 'del(.packing)' "$run/run.json" >t && mv t "$run/run.json"
  sha256sum sim/*.csv >sums
  [[ $(code_of "$grainlaw" simulate test.json -o sim) == 0 ]] && grep -q "run.json: damaged; put aside" err || fail "damaged run: $(cat err)"
  sha256sum -c sums >/dev/null || fail "the run made again is another"
else
  fail "simulate: $(cat err)"
fi
printf 'id,x,y,z,r\n0,0.001,0.001,0.001,0.001\n1,0.001,0.001,0.001,0.001\n' >s.csv
echo '{"spheres": "s.csv", "cell": [[0.01,0,0],[0,0.01,0],[0,0,0.01]], "segments": [{"mode": "D2", "extent": {"eps_dev": 0.02}}]}' >t.json
[[ $(code_of "$grainlaw" simulate t.json -o none) != 0 && ! -e none ]] || fail "a refused run left $(find none)"

# a limit of the shell, an output that takes nothing
(ulimit -f 100; [[ $(code_of "$grainlaw" report good -o big.html) == 1 ]]) && grep -q 'big.html: cannot be written (File too large)' err ||
  fail "beyond the limit: $(cat err)"
[[ ! -e big.html ]] || fail "half a page was left"
if [[ -w /dev/full ]]; then
  for word in --help --version help "calibrate --help"; do
    code=0
    "$grainlaw" $word >/dev/full 2>err || code=$?
    [[ $code == 1 ]] && grep -q 'standard output: cannot be written' err || fail "$word to /dev/full: $code $(cat err)"
  done
fi
