# Data that lie, and files that say what nobody reads: each is sown into good, shipped ones and must be refused with exit
# code 2 and one line that names file, row, column or key, the value and the likely cause. Prints one line for each lie.
set -euo pipefail
grainlaw=$1
fail() { echo "FAIL: $*" >&2; exit 1; }
shipped=$GRAINLAW_SOURCE_DIR/examples/paper/data
lies=0

# refuse NAME EXPECTED COMMAND...: prints the message.
refuse() {
  local name=$1 expected=$2 code=0
  shift 2
  "$@" -o out >stdout 2>stderr || code=$?
  [[ $code == 2 ]] || fail "$name: exit code $code, not 2: $(head -c 300 stderr)"
  [[ $(wc -l <stderr) == 1 && ! -s stdout ]] || fail "$name: not one line: $(head -c 600 stderr)"
  grep -Fq -- "$expected" stderr || fail "$name: expected '$expected', got: $(cat stderr)"
  [[ ! -e out ]] || fail "$name: left a folder behind"
  echo "lie '$name': $(cat stderr)"
  lies=$((lies + 1))
}

# foreign FROM TO FILTER: a data set as others would make it, without digests, with only the columns that are needed.
needed='^(time\[s\]|segment|strain_..|nu|stress_..\[Pa\]|fabric_..|C_star|rattler_fraction)$'
foreign() {
  mkdir -p "$2"
  jq "{tests: [.tests[] | select($3) | {name, role, path, packing: (.packing | {seed, mean_radius, stiffness})}]}" \
    "$1/dataset.json" >"$2/dataset.json"
  local test
  for test in $(jq -r '.tests[].name' "$2/dataset.json"); do
    awk -F, -v needed="$needed" 'BEGIN { OFS = "," }
      NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ needed) take[++n] = i }
      { line = $take[1]; for (k = 2; k <= n; ++k) line = line "," $take[k]; print line }' "$1/$test.csv" >"$2/$test.csv"
  done
}

# sow FOLDER TEST CODE: changes the rows of a copy of the data set, "lie"; CODE is awk with c["name"] for a column's number.
sow() {
  rm -rf lie && cp -r "$1" lie
  awk -F, 'BEGIN { OFS = ","; CONVFMT = OFMT = "%.17g" }
    function times(names, factor,  i, list, n) { n = split(names, list, " "); for (i = 1; i <= n; ++i) $c[list[i]] *= factor }
    function swap(a, b,  kept) { kept = $c[a]; $c[a] = $c[b]; $c[b] = kept }
    NR == 1 { for (i = 1; i <= NF; ++i) { name = $i; sub(/\[.*/, "", name); c[name] = i }; print; next }
    { '"$3"'; print }' "$1/$2.csv" >"lie/$2.csv"
}
stress='"stress_xx stress_yy stress_zz stress_yz stress_xz stress_xy"'
strain='"strain_xx strain_yy strain_zz strain_yz strain_xz strain_xy"'
fabric='"fabric_xx fabric_yy fabric_zz fabric_yz fabric_xz fabric_xy"'

foreign "$shipped/dataset" good '.name == "ISO-unloading-s1" or .name == "D2-0.70-s1" or .name == "D2-0.74-s1"'
lie() {
  sow good "$2" "$3"
  refuse "$1" "lie/$2.csv: row $4" "$grainlaw" calibrate --dataset lie
  grep -Fq -- "$5" stderr || fail "$1: expected '$5', got: $(cat stderr)"
}

iso=ISO-unloading-s1 d2=D2-0.70-s1
lie 'stress is tension positive' $d2 "times($stress, -1)" "1, column 'stress_xx'" 'change the sign of its six columns'
lie 'stress is tension positive, isotropic' $iso "times($stress, -1)" "1, column 'stress_xx'" 'tension'
lie 'stress in kPa' $d2 "times($stress, 1e-3)" "1, column 'P_star'" 'stress in Pa'
lie 'stress in MPa' $iso "times($stress, 1e-6)" "1, column 'P_star'" 'stress in Pa'
lie 'stress without its unit' $d2 "times($stress, 2e-11)" "1, column 'P_star'" 'units'
lie 'strain is compression positive' $iso "times($strain, -1)" "2, column 'nu'" 'change its sign'
lie 'strain of shear is compression positive' $d2 "times($strain, -1)" "2, column 'strain'" 'change its sign'
lie 'strain in per cent' $d2 "times($strain, 100)" "3, column 'strain'" 'in per cent'
lie 'strain is not logarithmic' $iso '$c["strain_xx"] = exp($c["strain_xx"]) - 1; $c["strain_yy"] = $c["strain_zz"] = $c["strain_xx"]' \
  "" "give the logarithmic one"
lie 'columns of stress swapped' $d2 'swap("stress_xx", "stress_zz")' "" "two of their columns are swapped"
lie 'columns of stress swapped across' $d2 'swap("stress_xx", "stress_yy")' "121, column 'stress'" 'swapped'
lie 'columns of fabric swapped' $d2 'swap("fabric_xx", "fabric_zz")' "121, column 'fabric'" 'swapped'
lie 'columns of strain swapped' $d2 'swap("strain_xx", "strain_yy")' "2, column 'strain'" 'columns swapped'
lie 'columns of numbers swapped' $d2 'swap("nu", "rattler_fraction")' "2, column 'nu'" 'columns swapped'
lie 'nu without rattlers' $iso '$c["nu"] *= 1 - $c["rattler_fraction"]' "" "column 'nu'"
lie 'nu off by 0.01' $d2 '$c["nu"] += 0.01' "1, column 'nu'" 'the path starts at initial.nu = 0.7'
lie 'C_star counts contacts once' $d2 'times("C_star", 0.5)' "1, column 'C_star'" 'counted once a pair'
lie 'C_star is C, rattlers included' $iso '$c["C_star"] *= 1 - $c["rattler_fraction"]' "" 'C = M4/N'
lie 'rattlers in per cent' $d2 'times("rattler_fraction", 100)' "1, column 'rattler_fraction'" 'in per cent?'
lie 'fabric counts contacts once' $d2 "times($fabric, 0.5)" "1, column 'F_v'" 'contacts counted once'
lie 'fabric is normalised' $d2 "F = \$c[\"fabric_xx\"] + \$c[\"fabric_yy\"] + \$c[\"fabric_zz\"]; times($fabric, 1 / F)" "1, column 'F_v'" 'normalised'
lie 'fabric is a deviator' $d2 'F = ($c["fabric_xx"] + $c["fabric_yy"] + $c["fabric_zz"]) / 3; $c["fabric_xx"] -= F; $c["fabric_yy"] -= F; $c["fabric_zz"] -= F' \
  "1, column 'fabric_xx'" 'is it a deviator'

# the path as well: only the work of the stress tells
sow good $d2 "times($strain, -1)"
jq '(.tests[] | select(.name == "'$d2'") | .path.segments[0]) |= {rate_tensor: [[-1,0,0],[0,0,0],[0,0,1]], extent}' good/dataset.json >lie/dataset.json
refuse 'strain and path are compression positive' "column 'stress': its work on the shear" "$grainlaw" calibrate --dataset lie
sow good $d2 ''
jq '(.tests[].packing.mean_radius) *= 1000' good/dataset.json >lie/dataset.json
refuse 'mean_radius in mm' "column 'P_star'" "$grainlaw" calibrate --dataset lie

# what is good is taken, and what is compared is judged as what is fitted
"$grainlaw" calibrate --dataset "$shipped/dataset" -o law --quiet >/dev/null || fail "the shipped data are refused"
foreign "$shipped/uniaxial-0.728" uni '.packing.seed == 11'
path=$GRAINLAW_SOURCE_DIR/examples/paper/uniaxial-0.728.json
"$grainlaw" predict law/parameters.json "$path" --against uni --model evolution -o plain --quiet >/dev/null || fail "good runs are refused"
against() {
  sow uni UNI-0.728-s11 "$2"
  refuse "$1" "lie/UNI-0.728-s11.csv: row $3" "$grainlaw" predict law/parameters.json "$path" --against lie
}
against 'compared with tension positive stress' "times($stress, -1)" "1, column 'stress_xx'"
against 'compared with columns swapped' 'swap("stress_xx", "stress_zz")' ""
against 'compared with compression positive strain' "times($strain, -1)" "2, column 'nu'"

# a start that is not jammed, in the law or in what was measured
echo '{"initial": {"nu": 0.66}, "segments": [{"mode": "D2", "extent": {"eps_dev": 0.1}}]}' >loose.json
refuse 'a start below jamming' 'loose.json: initial.nu: the start is not jammed: nu = 0.66 is not above' \
  "$grainlaw" predict law/parameters.json loose.json

# keys that a state does not read
printf 'id,x,y,z,r\n0,0.001,0.001,0.001,0.001\n1,0.00295,0.001,0.001,0.001\n' >s.csv
echo '{"spheres": "s.csv", "cell": [[0.02,0,0],[-0.0,0.02,0],[0,-0.0,0.02]]}' >two.json
"$grainlaw" simulate two.json -o two --quiet >/dev/null || fail "-0.0 of a cell is refused: $(cat stderr)"
for key in stiffness density contact_viscosity background_viscosity; do
  echo '{"state": "two/end.state", "'$key'": 3}' >test.json
  refuse "$key beside a state" "test.json: $key: is not read, the state has its own; remove it" "$grainlaw" simulate test.json
done
echo '{"state": "two/end.state", "mean_radius": 0.002}' >test.json
refuse 'mean_radius beside a state' 'test.json: mean_radius: belongs to a packing that is made' "$grainlaw" simulate test.json
echo '{"initial": {"nu": 0.7}, "relax": true, "segments": [{"mode": "D2", "extent": {"eps_dev": 0.1}}]}' >test.json
refuse 'relax beside initial' 'test.json: relax: belongs to spheres or state' "$grainlaw" simulate test.json

# a test does not write over what it starts from
echo '{"state": "end.state"}' >two/on.json
cp two/end.state kept.state
for folder in two two/.; do
  ! "$grainlaw" simulate two/on.json -o $folder >stdout 2>stderr || fail "wrote over its start in $folder"
  grep -q 'two/end.state: the test starts from it and would overwrite it' stderr || fail "$(cat stderr)"
  cmp two/end.state kept.state || fail "the start has changed"
done
(cd two && ! "$grainlaw" simulate on.json -o . 2>../stderr) || fail "wrote over its start in its own folder"

# packings that no simulation can start from
echo '{"spheres": "s.csv", "cell": [[4e-4,0,0],[0,0.02,0],[0,0,0.02]]}' >test.json
refuse 'a cell far smaller than a sphere' 's.csv: radius 0.001 does not fit a cell of height' "$grainlaw" simulate test.json
echo '{"spheres": "s.csv", "cell": [[0.02,0,0],[0,0.02,0],[0,0,0.02]], "contact_viscosity": 40}' >test.json
refuse 'a step that damping makes unstable' 'test.json: time_step_fraction: 0.1 is unstable with this contact_viscosity' \
  "$grainlaw" simulate test.json
echo '{"contact_viscosity": 14}' >spec.json
refuse 'a step that damping makes unstable, by its spec' 'spec.json: time_step_fraction: 0.1 is unstable' "$grainlaw" calibrate spec.json
printf 'id,x,y,z,r\n0,0.001,0.001,0.001,0.001\n1,0.001,0.001,0.001,-0.0005\n' >s.csv
refuse 'a negative radius' 's.csv: line 3, column r' "$grainlaw" simulate two.json
echo "lies.refused $lies"
