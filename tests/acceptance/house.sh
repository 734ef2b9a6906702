#!/usr/bin/env bash
# tests/acceptance/house.sh [--quick] [--base DIR]: whether the house is in order and gives the old results, one line each:
#   NAME VALUE BOUND ok|short          exit 0 only if none is short; "aim" before a bound: wanted, not required
# The old results are those of b8135ea, whose sources and build/release lie in DIR; without it they are made in build/house/base.
# Whether the re-cut changed a digit is asked of 3373ed0, where it ended, in build/house/recut. Today's program has another law of
# memory (since d122e73), standard errors moderated by a prior, and bands by them: of it, series and values of parameters are
# compared, those of memory aside. All on the inputs of 3373ed0, which all three programs read.
# --quick: lines, files and arrows, what a change touches, and with --base today's digits of the refit. Otherwise also the changes built
# and tested, the other digits, a folder of the old program taken up, the installed libraries, and speeds.
# Run it alone: speeds are measured side by side on a pinned core. 20 minutes, of which most go into compiling.
set -euo pipefail

base=
rest=()
while (($# > 0)); do
  case $1 in
    --base) base=$(realpath "${2:?--base DIR}"); shift 2 ;;
    *) rest+=("$1"); shift ;;
  esac
done
set -- "${rest[@]}"
# shellcheck source=tests/acceptance/setup.sh
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" "$@"
old_commit=b8135ea recut_commit=3373ed0
rooms=(model dem fit predict chain app)
out=$PWD/build/house
mkdir -p "$out"
new=$PWD/$bin/grainlaw

# A figure that is wanted, not required.
aim() { # name value most
  printf '%s %s aim<=%s %s\n' "$1" "$2" "$3" "$(awk -v v="$2" -v m="$3" 'BEGIN { print v <= m ? "ok" : "short" }')"
}

sources() { git ls-files -- "${@/%//*.hpp}" "${@/%//*.cpp}"; }  # of rooms
lines_of() { sources "$@" | xargs cat | wc -l; }

size() {
  local room lines
  for room in "${rooms[@]}"; do
    figure "size.$room.lines" "$(lines_of "$room")" stated
    figure "size.$room.files" "$(sources "$room" | wc -l)" stated
  done
  lines=$(lines_of "${rooms[@]}")
  aim size.lines "$lines" 27000
  aim size.files "$(sources "${rooms[@]}" | wc -l)" 280
  figure size.files_under_30_lines "$(sources "${rooms[@]}" | xargs wc -l | awk '$2 != "total" && $1 < 30' | wc -l)" stated
  figure size.app.percent "$(awk -v app="$(lines_of app)" -v all="$lines" 'BEGIN { printf "%.1f", 100 * app / all }')" "<=22"
}

# Each arrow between rooms and within them against tests/architecture/include_rules.txt; the check itself must be able to fail.
arrows() {
  tests/architecture/check_includes.sh . >"$out/arrows.txt" || true
  figure arrows.files "$(awk 'END { print $1 }' "$out/arrows.txt")" ">=200"
  figure arrows.violations "$(awk 'END { print $3 }' "$out/arrows.txt")" "<=0"
  figure arrows.violations_not_caught "$(tests/architecture/checks_can_fail.sh | awk 'END { print $1 }')" "<=0"
}

# A clone in build/house, at a commit; what it built before stays.
clone() { # name commit
  [[ -d $out/$1/.git ]] || git clone --quiet --no-checkout "$PWD" "$out/$1"
  git -C "$out/$1" fetch --quiet origin "+refs/*:refs/here/*"
  git -C "$out/$1" checkout --quiet --force --detach "$2"
}

# What a change touches, and whether it works: a patch of tests/acceptance/changes on a scratch copy of HEAD.
# Its tests are whole executables, with all that was tested before.
change() { # name most-product-files executable...
  local name=$1 most=$2 copy=$out/scratch touched executable log passed=0
  shift 2
  clone scratch "$(git rev-parse HEAD)"
  if ! git -C "$copy" apply --index "$PWD/tests/acceptance/changes/$name.patch" 2>"$out/$name.log"; then
    figure "change.$name.product_files" does_not_apply "<=$most"
    return
  fi
  touched=$(git -C "$copy" diff --cached --name-only -- "${rooms[@]}")
  figure "change.$name.product_files" "$(wc -l <<<"$touched")" "<=$most"
  figure "change.$name.product_lines" \
    "$(git -C "$copy" diff --cached --numstat -- "${rooms[@]}" | awk '{ n += $1 } END { print n }')" stated
  if [[ $quick == no ]]; then
    if (cd "$copy" && cmake --preset release --log-level=WARNING -DGRAINLAW_LONG=OFF -DGRAINLAW_WERROR=ON &&
        cmake --build build/release --parallel "$(nproc)" --target "$@") >"$out/$name.log" 2>&1; then
      for executable in "$@"; do
        log=$(cd "$copy" && "build/release/bin/$executable" 2>&1) && passed=$((passed + 1))
        printf '%s\n' "$log" >>"$out/$name.log"
      done
    else
      tail -3 "$out/$name.log" >&2
    fi
    figure "change.$name.executables_passed" "$passed" ">=$#"
  fi
}

changes() {
  # of a column that follows from the others of its row
  change column_of_a_series 1 unit_dem unit_app
  change parameter_of_the_law 3 unit_model unit_fit
  change state_variable 5 unit_model unit_fit unit_predict
}

built() { # name commit: the program of a commit, in build/house
  clone "$1" "$2"
  (cd "$out/$1" && cmake --preset release --log-level=WARNING -DGRAINLAW_LONG=OFF &&
   cmake --build build/release --parallel "$(nproc)" --target grainlaw) >"$out/$1.log" 2>&1
}

old_program() {
  if [[ -z $base ]]; then
    built base $old_commit
    base=$out/base
  fi
  clone recut $recut_commit
  old=$base/build/release/bin/grainlaw
  "$old" --version >&2
}

# Values of a JSON file of the old program that another has not, who, when and how long aside. Added keys are none of them.
differing_values() { # old.json new.json
  jq -n --slurpfile old "$1" --slurpfile new "$2" '
    def bare: walk(if type == "object" then del(.provenance, .seconds, .cost, .wall_time, .sha256, .digest, .dataset_digest,
                                               .file, .run, .runs, .key) else . end);
    ($new[0] | bare) as $b | $old[0] | bare | . as $a
    | [paths as $p | ($a | getpath($p)) as $x | (try ($b | getpath($p)) catch "none") as $y
       | select(($x | type) != ($y | type) or (($x | type) == "array" and ($x | length) != ($y | length))
                or (($x | type | IN("object", "array") | not) and $x != $y))] | length'
}

# Over all of the old folder but runs and the report: "FILES DIFFERENCES".
differences() { # old new
  local file files=0 sum=0
  while read -r file; do
    files=$((files + 1))
    if [[ ! -f $2/$file ]]; then
      sum=$((sum + 1))
    elif [[ $file == *.json ]]; then
      sum=$((sum + $(differing_values "$1/$file" "$2/$file")))
    elif ! cmp -s "$1/$file" "$2/$file"; then
      sum=$((sum + 1))
    fi
  done < <(cd "$1" && find . \( -name runs -o -name spec.resolved.json \) -prune \
             -o \( -name '*.json' -o -name '*.csv' \) -print | sort)
  echo "$files $sum"
}

digits() { # name old-folder new-folder least-files
  local files sum
  read -r files sum < <(differences "$2" "$3")
  figure "$1.files" "$files" ">=$4"
  figure "$1.differing_values" "$sum" "<=0"
}

refit() { # program folder
  local path name
  cd "$out/recut"
  "$1" calibrate --dataset examples/paper/data/dataset -o "$2" --quiet >/dev/null
  for path in examples/paper/uniaxial-*.json; do
    name=$(basename "$path" .json)
    "$1" predict "$2/parameters.json" "$path" --against "examples/paper/data/$name" -o "$2/predictions/$name" --quiet >/dev/null
  done
}

quickstart() { # program folder
  local path
  cd "$out/recut"
  "$1" calibrate examples/quickstart/spec.json -o "$2" --quiet >/dev/null
  for path in examples/quickstart/uniaxial-*.json; do
    "$1" predict "$2/parameters.json" "$path" --dem -o "$2/predictions/$(basename "$path" .json)" --quiet >/dev/null
  done
}

# Values of parameters.json, without those of memory.
values_outside_memory() {
  jq -S '.parameters | with_entries(select(.key | startswith("memory.") | not)) | map_values(.value)' "$1/parameters.json"
}

# Of a calibration by today's program: its series, and the values of its law but those of memory.
same_series_and_values() { # name old-folder new-folder least-series subfolder...
  local name=$1 file series=0 differ=0
  while read -r file; do
    series=$((series + 1))
    cmp -s "$2/$file" "$3/$file" || differ=$((differ + 1))
  done < <(cd "$2" && find "${@:5}" -name runs -prune -o -name '*.csv' -print | grep -E '^dataset/|/dem/')
  figure "$name.series" $series ">=$4"
  figure "$name.differing_series" $differ "<=0"
  figure "$name.values_outside_memory" "$(values_outside_memory "$2" | jq length)" ">=30"
  figure "$name.differing_values_outside_memory" \
    "$(jq -n --argjson old "$(values_outside_memory "$2")" --argjson new "$(values_outside_memory "$3")" \
         '[$old | keys[] | select($old[.] != $new[.])] | length')" "<=0"
}

today() { # refit or quickstart, least number of series
  rm -rf "${out:?}/$1"
  ("$1" "$old" "$out/$1/old")
  ("$1" "$new" "$out/$1/new")
  same_series_and_values "$1.today" "$out/$1/old" "$out/$1/new" "$2" dataset predictions
}

recut() { # refit or quickstart, least number of files
  ("$1" "$out/recut/build/release/bin/grainlaw" "$out/$1/recut")
  digits "$1" "$out/$1/old" "$out/$1/recut" "$2"
}

finished_runs() { find "$1/runs" -name run.json 2>/dev/null | sort; }

# The old program begins the quickstart and is interrupted half-way, the new one goes on.
taken_up() {
  local folder=$out/taken-up pid half code=0 before after
  rm -rf "$folder"
  half=$(($(finished_runs "$out/quickstart/old" | wc -l) / 2))
  set -m  # background jobs keep SIGINT
  "$old" calibrate "$out/recut/examples/quickstart/spec.json" -o "$folder" --quiet >/dev/null 2>"$out/taken-up.log" &
  pid=$!
  set +m
  until [[ $(finished_runs "$folder" | wc -l) -ge $half ]] || ! kill -0 $pid 2>/dev/null; do sleep 0.2; done
  kill -INT $pid 2>/dev/null || true
  wait $pid || code=$?
  figure taken_up.exit_code_of_the_interrupted "$code" ">=130"
  before=$(finished_runs "$folder" | xargs stat -c '%n %i %Y')
  figure taken_up.runs_finished_before "$(wc -l <<<"$before")" ">=$half"
  "$new" calibrate "$out/recut/examples/quickstart/spec.json" -o "$folder" --quiet --json >"$out/taken-up.json" \
    2>>"$out/taken-up.log" || true
  after=$(finished_runs "$folder" | xargs stat -c '%n %i %Y')
  figure taken_up.runs_found "$(jq -r '.runs_found // "missing"' "$out/taken-up.json")" ">=$(wc -l <<<"$before")"
  figure taken_up.runs_made_again "$(comm -23 <(sort <<<"$before") <(sort <<<"$after") | wc -l)" "<=0"
  same_series_and_values taken_up "$out/quickstart/old" "$folder" 20 dataset
}

# User seconds of a command on one core.
seconds_of() {
  local TIMEFORMAT=%U
  { time taskset -c 0 "$@" >/dev/null 2>&1; } 2>&1
}

# Least time of the new program over that of the old one, in turns.
paired() { # name most repeats arguments...
  local name=$1 most=$2 repeats=$3 i old_least=1e9 new_least=1e9
  shift 3
  least() { awk -v a="$1" -v b="$2" 'BEGIN { print b < a ? b : a }'; }
  for ((i = 0; i < repeats; ++i)); do
    rm -rf "$out/speed"
    old_least=$(least "$old_least" "$(seconds_of "$old" "$@" -o "$out/speed" --threads 1 --quiet)")
    rm -rf "$out/speed"
    new_least=$(least "$new_least" "$(seconds_of "$new" "$@" -o "$out/speed" --threads 1 --quiet)")
  done
  figure "speed.$name.old_seconds" "$old_least" ">=0.2"
  figure "speed.$name.new_seconds" "$new_least" stated
  figure "speed.$name.ratio" "$(awk -v o="$old_least" -v n="$new_least" 'BEGIN { printf "%.3f", n / o }')" "<=$most"
}

speeds() {
  figure speed.load_before "$(cut -d' ' -f1 /proc/loadavg)" stated
  echo '{"particles": 2000, "seed": 1, "initial": {"nu": 0.72}, "segments": [{"mode": "D2", "extent": {"eps_dev": 0.1}}]}' \
    >"$out/speed.json"
  paired engine 1.03 5 simulate "$out/speed.json"
  paired fit 1.03 5 calibrate --dataset examples/paper/data/dataset
  paired prediction 1.03 5 study integrator --parameters "$out/refit/old/parameters.json"
}

# The installed libraries in another project's hands: examples/library is built there, and its output is the program's.
installed() {
  local log=$out/installed.txt
  ctest --test-dir build/release -R '^install\.' --output-on-failure >"$log" 2>&1 || tail -5 "$log" >&2
  figure installed.tests_failed \
    "$(sed -n 's/.* \([0-9]*\) tests failed out of .*/\1/p' "$log" | grep . || echo missing)" "<=0"
  figure installed.library_example "$(grep -c 'install\.library_example .*Passed' "$log" || true)" ">=1"
}

size
arrows
changes
if [[ $quick == no || -n $base ]]; then
  old_program
  today refit 100
fi
if [[ $quick == no ]]; then
  today quickstart 20
  built recut $recut_commit
  recut refit 250
  recut quickstart 60
  taken_up
  installed
  speeds
fi
finish_figures
