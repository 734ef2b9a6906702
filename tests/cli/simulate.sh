# grainlaw simulate: a preparation, a path from it, a table of spheres, a state file.
set -euo pipefail
grainlaw=$1
fail() { echo "FAIL: $*" >&2; exit 1; }
small='"particles": 64, "seed": 3, "strain_rate": 5000, "rows": 20, "nu_end": 0.72'

echo "{$small, \"keep\": [{\"nu\": 0.74}, {\"nu\": 0.75, \"branch\": \"loading\"}]}" >packing.json
"$grainlaw" simulate packing.json -o packing >text 2>log || fail "$(cat log)"
for file in loading.csv unloading.csv unloading-0.74.state loading-0.75.state simulation.json; do [[ -s packing/$file ]] || fail "no $file"; done
grep -q '64 spheres, 21 rows, end of the unloading branch' text || fail "$(cat text)"

echo "{$small, \"initial\": {\"nu\": 0.74}, \"segments\": [{\"mode\": \"D2\", \"extent\": {\"eps_dev\": 0.02}}, {\"mode\": \"ISO\", \"extent\": {\"target_nu\": 0.75}}]}" >path.json
"$grainlaw" simulate path.json -o path --json >result.json 2>log || fail "$(cat log)"
for file in series.csv end.state end.csv simulation.json; do [[ -s path/$file ]] || fail "no $file"; done
(( $(wc -l <path/series.csv) == 42 )) || fail "rows"
cmp result.json path/simulation.json || fail "--json is not the summary on disk"

# small-strain probes on the way: at eps_dev 0, 0.01, 0.02 and at 0.03, in the compression; the run is the same
jq '.probes = {every: 0.01, step: [1e-7, 1e-6]}' path.json >probed.json
"$grainlaw" simulate probed.json -o probed --json --quiet >result.json
cmp path/series.csv probed/series.csv || fail "probes disturbed the run"
(( $(wc -l <probed/probes.csv) == 9 )) || fail "$(cat probed/probes.csv)"
head -1 probed/probes.csv | grep -q ',B_star,DG_star,A1_star,A2_star,' || fail "$(head -1 probed/probes.csv)"
jq -e '.files | contains(["probes.csv"])' result.json >/dev/null || fail "$(jq .files result.json)"
code=0
jq 'del(.initial, .segments)' probed.json >nowhere.json
"$grainlaw" simulate nowhere.json -o nowhere 2>err || code=$?
[[ $code == 2 && ! -e nowhere ]] && grep -q 'probes: belong to a test' err || fail "probes of a preparation: $(cat err)"

# on from the state where the path ended, and from its table of spheres in the same cell
echo '{"state": "path/end.state", "strain_rate": 5000, "rows": 5, "segments": [{"mode": "UNI", "extent": {"eps_dev": 0.002}}]}' >on.json
"$grainlaw" simulate on.json -o on --quiet >text
grep -q 'nu  *0.7515' text || fail "UNI from 0.75 by 0.002 ends at 0.75 exp(0.002): $(cat text)"
cell=$(tr -d '\n ' <path/simulation.json | grep -o '"cell":\[\[[^]]*\],\[[^]]*\],\[[^]]*\]\]')
cp path/end.csv spheres.csv
echo "{\"spheres\": \"spheres.csv\", $cell, \"rows\": 5}" >spheres.json
"$grainlaw" simulate spheres.json -o spheres --json --quiet >result.json
pressure() { grep -m1 '"P_star"' "$1" | tr -d ' ,' | cut -d: -f2; }
awk -v a="$(pressure path/simulation.json)" -v b="$(pressure result.json)" 'BEGIN { exit !(a > 0 && (a - b)^2 <= 1e-18 * a^2) }' \
  || fail "P* of the table $(pressure result.json), of the state $(pressure path/simulation.json)"
"$grainlaw" simulate spheres.json -o spheres --json --quiet >again.json
cmp <(grep '"run"' result.json) <(grep '"run"' again.json) || fail "another run"

# frames stand where they belong, also behind a segment of few steps; what another test left in the folder goes
jq '.frames = 9 | .strain_rate = 50 | .segments = [{mode: "UNI", extent: {eps_dev: 1e-6}}, {mode: "UNI", extent: {eps_dev: 0.01}}]' on.json >frames.json
"$grainlaw" simulate frames.json -o again --quiet >/dev/null
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) { sub(/\[.*/, "", $i); c[$i] = i } next }
  $c["segment"] == 1 { ++n; e[n] = $c["e"] }
  END { if (n != 9) exit 1; for (i = 1; i <= 9; ++i) if (e[i] < i / 9 * e[9] - 1e-12 || e[i] > (i + 0.5) / 9 * e[9]) exit 1 }' \
  again/frames.csv || fail "frames: $(cat again/frames.csv)"
"$grainlaw" simulate on.json -o again --quiet >/dev/null
cmp <(cd again && ls -- *.state *.csv) <(jq -r '.files[]' again/simulation.json | sort) || fail "left: $(ls again)"
echo mine >again/loading.csv
"$grainlaw" simulate on.json -o again --quiet >/dev/null
[[ $(cat again/loading.csv) == mine ]] || fail "a file of the user's is gone"

# two spheres that do not touch: what has no value is null, with the reason (hard case D21)
printf 'id,x,y,z,r,vx,vy,vz\n0,0.001,0.001,0.001,0.001,0,0,0\n1,0.006,0.006,0.006,0.001,0,0,0\n' >apart.csv
echo '{"spheres": "apart.csv", "cell": [[0.01,0,0],[0,0.01,0],[0,0,0.01]]}' >apart.json
"$grainlaw" simulate apart.json -o apart --json --quiet >result.json
jq -e '.end.s_dev == null and .undefined.s_dev == "the pressure is not positive" and .end.C_star == null and
       .undefined.C_star == "no sphere has four contacts" and .end["P_star"] == 0' result.json >/dev/null || fail "$(jq -c '.end, .undefined' result.json)"
