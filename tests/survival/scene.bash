# Sourced by the survival scripts: a preparation and a test of few spheres that take a fraction of a second, run whole
# once as the reference, and the questions that follow a mishap.
grainlaw=$1
export ASAN_OPTIONS="${ASAN_OPTIONS:-}:detect_leaks=0"  # the leak sanitizer cannot work in a traced process
fail() { echo "FAIL: $*" >&2; exit 1; }

cat >test.json <<'JSON'
{"particles": 60, "seed": 3, "strain_rate": 8000, "rows": 20, "nu_end": 0.73, "initial": {"nu": 0.74},
 "segments": [{"mode": "D2", "extent": {"eps_dev": 0.05}}, {"mode": "ISO", "extent": {"target_nu": 0.75}}]}
JSON

# Digests of what a run yields: series and states, under their final names.
results() { (cd "$1" && find . \( -name '*.csv' -o -name '*.state' \) -printf '%P\n' | sort | xargs -r sha256sum); }

simulate() { # folder option...
  "$grainlaw" simulate test.json -o "$1" --threads 1 --quiet "${@:2}"
}

sound=0  # how often check_finished agreed

# The results in a folder are those of the uninterrupted run, and nothing is left over.
check_finished() { # folder what
  [[ $(results "$1") == "$reference" ]] || fail "$2: other results than the uninterrupted run"
  [[ -z $(find "$1" -name 'checkpoint*' -o -name 'progress.json' -o -name '.*.tmp-*') ]] || fail "$2: scratch files are left"
  sound=$((sound + 1))
}

# Whatever has a final name is whole: JSON parses, and states and series that are in the reference equal it. Prints the
# number of finished runs.
check_unfinished() { # folder what
  local file name sum
  while read -r file; do
    jq -e . "$file" >/dev/null 2>&1 || fail "$2: half a file under the final name $file"
  done < <(find "$1" -name '*.json' 2>/dev/null)
  while read -r sum name; do
    grep -q "^$sum  $name$" <<<"$reference" || fail "$2: $name has a final name and other content"
  done < <([[ ! -d $1 ]] || results "$1")
  { find "$1" -name run.json 2>/dev/null || true; } | wc -l
}

# The same scene at an eighth of the rate, where a mishap must hit the run amid its work; whole_seconds is what the
# uninterrupted run takes here and now.
slow_down() {
  local before
  sed -i 's/"strain_rate": 8000/"strain_rate": 1000/' test.json
  rm -rf whole
  before=$(date +%s.%N)
  simulate whole >/dev/null
  whole_seconds=$(awk -v b="$before" -v a="$(date +%s.%N)" 'BEGIN { print a - b }')
  reference=$(results whole)
}

simulate whole >/dev/null
reference=$(results whole)
[[ $(wc -l <<<"$reference") -ge 6 ]] || fail "the reference run yields too little: $reference"
