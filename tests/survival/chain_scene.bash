# Sourced by the scripts that strike the whole chain: a tiny one, run whole once as the reference, and the questions that follow
# a mishap. Each step begins with a folder of its own, start/STEP, and works in the folder work. Findings are told and counted;
# found_nothing at the end fails if there were any.
set -euo pipefail
grainlaw=$(realpath "$1")
export LC_ALL=C
ulimit -c 0
fail() { echo "FAIL: $*" >&2; exit 1; }
findings=0
finding() { findings=$((findings + 1)); echo "FINDING $findings: $*" >&2; }
found_nothing() { ((findings == 0)) || fail "$findings findings"; }

steps=(npz-export vtp-export vtkhdf-export import foreign-import prepare simulate predict report fit dem-predict fit-threads
       calibrate rehearse calibrate-again calibrate-threads)
declare -A command=(
  [simulate]="simulate test.json -o out --frames 2 --threads 1 --checkpoint 0.01"
  [prepare]="simulate packing.json -o out --threads 1"
  [calibrate]="calibrate spec.json -o out --threads 1"
  [calibrate-again]="calibrate spec.json -o out --threads 1"
  [calibrate-threads]="calibrate spec.json -o out --threads 3"
  [fit]="calibrate --dataset dataset -o out --threads 1"
  [fit-threads]="calibrate --dataset dataset -o out --threads 3"
  [predict]="predict law/parameters.json path.json --model reduced -o law/predictions/p --threads 1"
  [dem-predict]="predict law/parameters.json path.json --model reduced -o law/predictions/p --dem --threads 1"
  [rehearse]="predict law/parameters.json path.json --model reduced -o law/predictions/p --dem --rehearse --threads 1"
  [report]="report judged -o report.html --threads 1"
  [vtp-export]="export sim -o out --format vtp --threads 1"
  [vtkhdf-export]="export sim -o out --format vtkhdf --threads 1"
  [npz-export]="export sim -o out --format npz --threads 1"
  [import]="import mapping.json -o out --threads 1"
  [foreign-import]="import foreign.json -o out --threads 1")

start_of() { rm -rf work && cp -r "start/$1" work; } # STEP
run_step() { # STEP: in the folder work
  # shellcheck disable=SC2086
  (cd work && exec "$grainlaw" ${command[$1]} --quiet)
}

# The files of a folder as lines, sorted: digest and name; those of JSON as they parse, without costs and who made them when.
tree_of() { # folder
  (
    cd "$1"
    find . -name '*.json' ! -name progress.json -print0 | xargs -0r jq -cS '[input_filename,
      walk(if type == "object" then del(.cost, .provenance, .sha256, .digest, .dataset_digest, .seconds) else . end)]'
    find . -type f ! -name '*.json' ! -name 'checkpoint*' ! -path '*/.?*' ! -path '*.lock/*' -print0 | xargs -0r sha256sum
  ) | sort
}
leftovers_of() { # folder
  (cd "$1" && find . -name 'checkpoint*' -o -name progress.json -o -name '.?*' -o -name '*.lock' -o -name '*.damaged')
}

# What is there is that of the reference or of the beginning, and whole, whatever struck. The table of frames grows while a run is
# on its way.
check_unfinished() { # STEP WHAT
  tree_of work >tree 2>half || true
  [[ ! -s half ]] || { finding "$2: half a file under a final name: $(cat half)"; return 1; }
  comm -23 tree "reference/$1" | comm -23 - "reference/$1.before" | grep -v '/frames.csv$' >other || return 0
  local name
  name=$(head -1 other | cut -c 1-100) # and the words that are not in the reference
  finding "$2: another content: $name $(head -1 other | tr ',' '\n' | grep -vxFf <(tr ',' '\n' <"reference/$1") | head -c 300)"
  return 1
}
# All that is in the reference, and nothing left over.
check_finished() { # STEP WHAT
  check_unfinished "$1" "$2" || return 1
  cmp -s tree "reference/$1" || { finding "$2: misses $(comm -13 tree "reference/$1" | cut -c 1-200)"; return 1; }
  [[ -z $(leftovers_of work) ]] || { finding "$2: leaves $(leftovers_of work)"; return 1; }
}

mkdir scene start reference
cat >scene/packing.json <<'JSON'
{"particles": 40, "seed": 3, "strain_rate": 8000, "rows": 10, "nu_end": 0.72, "nu_max": 0.76, "keep": [{"nu": 0.74}]}
JSON
cat >scene/test.json <<'JSON'
{"particles": 40, "seed": 3, "strain_rate": 8000, "rows": 10, "nu_end": 0.73, "initial": {"nu": 0.74},
 "segments": [{"mode": "D2", "extent": {"eps_dev": 0.02}}, {"mode": "ISO", "extent": {"target_nu": 0.75}}]}
JSON
cat >scene/spec.json <<'JSON'
{"particles": 64, "seeds": [1, 2], "strain_rate": 8000, "rows": 20, "nu_end": 0.67, "densities": [0.72, 0.76],
 "tests": [{"mode": "ISO", "role": "calibration"}, {"mode": "D2", "role": "calibration", "strain": 0.1}]}
JSON
cat >scene/path.json <<'JSON'
{"initial": {"nu": 0.74, "branch": "unloading"}, "seeds": [7], "rows": 6, "segments": [{"mode": "D2", "extent": {"eps_dev": 0.02}}]}
JSON

# The starters' data set with every ROWS-th row of all tests but TESTS.
thinned() { # ROWS TESTS FOLDER
  cp -r "$GRAINLAW_SOURCE_DIR/examples/starters/dataset" "$3"
  for file in "$3"/*.csv; do awk -v n="$1" 'NR == 1 || NR % n == 2' "$file" >rows && mv rows "$file"; done
  jq --arg but "$2" '.tests |= map(select(.name | test($but) | not))' "$3/dataset.json" >rows && mv rows "$3/dataset.json"
}
(
  cd scene
  thinned 3 "s3|0.75" lawful
  thinned 6 "s3|0.75|0.71" dataset
  "$grainlaw" calibrate --dataset lawful -o law --threads 1 --quiet || (($? == 3))
  cp spec.json law/spec.resolved.json
  "$grainlaw" simulate test.json -o sim --frames 2 --threads 1 --quiet
  cp -r law judged
  "$grainlaw" predict judged/parameters.json path.json --model reduced --dem -o judged/predictions/p --threads 1 --quiet
  "$grainlaw" calibrate spec.json -o calibrated --threads 1 --quiet
  jq '{source: "test", packings: ([.tests[].packing] | unique | map({key: "p\(.seed)", value: .}) | from_entries),
       series: {sign: {strain: "tension"}},
       tests: [.tests[] | {name, role, packing: "p\(.packing.seed)", series: {file: "dataset/\(.name).csv"}}]}' \
    dataset/dataset.json >mapping.json
  "$grainlaw" export sim --format npz -o npz
  "$grainlaw" export sim --format lammps-dump -o dump
  cat >foreign.json <<'JSON'
{"source": "test", "packings": {"A": {"particles": 40, "mean_radius": 1e-3, "stiffness": 1e8}}, "tests": [
 {"name": "npz", "role": "validation", "packing": "A",
  "series": {"file": "npz/series.npz", "sign": {"strain": "tension", "stress": "compression"}, "units": {"stress": "Pa"}}},
 {"name": "dump", "role": "validation", "packing": "A", "path_tolerance": 1e-3, "particles": {"format": "lammps-dump",
  "files": ["dump/frames.spheres.dump"], "contacts": {"files": ["dump/frames.contacts.dump"]}}},
 {"name": "states", "role": "validation", "packing": "A", "path_tolerance": 1e-3,
  "particles": {"format": "state", "files": ["sim/frame-*.state"]}}]}
JSON
) >log 2>&1 || fail "the scene: $(cat log)"

# needs STEP FILE...: what the step finds in its folder
needs() { mkdir "start/$1" && cp -r "${@:2}" "start/$1"; }
needs simulate scene/test.json
needs prepare scene/packing.json
needs calibrate scene/spec.json
needs calibrate-again scene/spec.json && cp -r scene/calibrated start/calibrate-again/out
needs calibrate-threads scene/spec.json
needs fit scene/dataset
needs fit-threads scene/dataset
needs predict scene/{law,path.json}
needs dem-predict scene/{law,path.json}
needs report scene/judged
for format in vtp vtkhdf npz; do needs ${format}-export scene/sim; done
needs import scene/{dataset,mapping.json}
needs rehearse scene/{law,path.json}
needs foreign-import scene/{npz,dump,sim,foreign.json}

declare -A codes seconds  # exit code 3 where so little does not make a fit converge
for step in "${steps[@]}"; do
  tree_of "start/$step" >"reference/$step.before"
  if [[ -e reference/${step%-*} ]]; then  # the same by other means
    cp "reference/${step%-*}" "reference/$step" && cp "reference/${step%-*}.said" "reference/$step.said"
    codes[$step]=${codes[${step%-*}]} seconds[$step]=${seconds[${step%-*}]}
    continue
  fi
  start_of "$step"
  codes[$step]=0 began=$(date +%s%N)
  run_step "$step" >"reference/$step.said" 2>log || codes[$step]=$?
  seconds[$step]=$((($(date +%s%N) - began) / 1000000))e-3
  ((codes[$step] == 0 || codes[$step] == 3)) || fail "$step without a fault: $(cat log)"
  tree_of work >"reference/$step"
done
