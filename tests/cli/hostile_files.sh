# What any JSON or CSV file may have wrong with it (the kinds of cases of JSONTestSuite), through every command that reads one: either
# read as what it says, or refused with exit code 2 and one line that names the file (check: one for each fault), within 2 s of
# processor time and 2.5 GB of addresses.
set -euo pipefail
grainlaw=$1
fail() { echo "FAIL: $*" >&2; exit 1; }
source=$GRAINLAW_SOURCE_DIR
bash "$source/tests/fuzz/scene.sh" "$grainlaw" scene
mkdir -p law/{predictions,studies}
"$grainlaw" calibrate --dataset "$source/examples/starters/dataset" -o law --quiet >/dev/null
cp -r scene/prediction law/predictions/p
cp -r scene/comparison law/predictions/compared
cp -r scene/study law/studies/s
cp scene/pictures/pictures.json law/dataset
"$grainlaw" report law -o sound.html >/dev/null || fail "the sound folder is refused"
limits=(-v 2500000 -t 10)
if grep -qE '__(asan|tsan)_init' "$grainlaw"; then  # such a program takes terabytes of addresses, and limits its memory itself
  limits=(-t 10)
  export ASAN_OPTIONS=${ASAN_OPTIONS:-}:hard_rss_limit_mb=2500 TSAN_OPTIONS=${TSAN_OPTIONS:-}:hard_rss_limit_mb=2500
fi

# call READER FILE: the command that reads it
call() {
  case $1 in
    report) "$grainlaw" report law -o report.html ;;
    submit) "$grainlaw" submit scene/listed --slurm --dry-run ;;
    *) "$grainlaw" check "$2" ;;
  esac
}
# judge accepted|refused READER FILE CASE: FILE holds the case
judge() {
  local code=0 lines
  (ulimit "${limits[@]}"; call "$2" "$3") >stdout 2>stderr || code=$?
  lines=$(grep -c . stderr) || true
  if [[ $1 == accepted ]]; then
    [[ $code == 0 ]] || fail "$3, $4: exit code $code: $(head -c 400 stderr)"
  else
    [[ $code == 2 && $lines -ge 1 && $lines -le $([[ $2 == check ]] && echo 50 || echo 1) ]] || fail "$3, $4: exit code $code, $lines lines: $(head -c 400 stderr)"
    (( $(LC_ALL=C wc -L <stderr) < 1500 )) || fail "$3, $4: a line of $(wc -L <stderr)"
    grep -aFq "$(basename "$3")" stderr || fail "$3, $4: the file is not named: $(cat stderr)"
    LC_ALL=C grep -aq $'[\x01-\x08\x0b-\x1f\x7f]\|\xc2\x9b\|\xe2\x80\xae' stderr && fail "$3, $4: control characters: $(cat -v stderr)"
  fi
  return 0
}

repeat() { head -c "$2" /dev/zero | tr '\0' "$1"; }
many_keys() { seq -f '"k%.0f": 1,' 100000; }
json_files=(
  "check scene/seeds/spec/small.json user" "check scene/path/path.json user" "check scene/test/test.json user"
  "check scene/dataset/dataset.json own" "check scene/parameters/parameters.json own" "check scene/prior/prior.json own"
  "report law/calibration.json own" "report law/fitted_paths.json own" "report law/dataset/pictures.json own"
  "report law/predictions/p/prediction.json own" "report law/predictions/compared/comparison.json own" "report law/studies/s/study.json own"
  "submit scene/listed/tasks/tasks.json own")
for entry in "${json_files[@]}"; do
  read -r reader file whose <<<"$entry"
  cp "$file" sound
  first=$(grep -o -m1 '"[a-z$_]*"' sound | head -1)
  rest=$(sed '1s/^{//' sound)
  # document CASE EXPECTED: the file is what stands on standard input
  document() { cat >"$file"; judge "$2" "$reader" "$file" "$1"; }
  # member CASE TEXT: a first member of the object as TEXT
  member() { { printf '{%b,' "$2"; echo "$rest"; } >"$file"; judge refused "$reader" "$file" "$1"; }

  document 'white space around it' accepted < <(printf '\n\t \r\n'; cat sound; printf '\r\n\n')
  for text in '' ' ' 3 '"x"' null true '[]' '[{}]' '{' '}' '[1,]' '{,}' nan -Infinity; do
    document "'$text' alone" refused < <(printf '%s' "$text")
  done
  document 'a byte order mark' refused < <(printf '\xef\xbb\xbf'; cat sound)
  document 'UTF-16' refused < <(printf '\xff\xfe'; sed 's/./&\x00/g' sound)
  document 'a NUL byte at the end' refused < <(cat sound; printf '\0')
  document 'something behind it' refused < <(cat sound; printf 'x')
  document 'another document behind it' refused < <(cat sound sound)
  document 'no end' refused < <(head -c -3 sound)
  for text in 01 +1 .5 1. 1e 1e999 -1e999 0x10 - NaN Infinity -Infinity TRUE nul "'x'" '"a' '"\\ud800"' '"\\udc00\\ud800"' '"\\x41"' \
    '"a\tb"' '"a\nb"' '"\xff"' '"\xc0\x80"' '"\xed\xa0\x80"' '"\xf4\x90\x80\x80"' '[' '[1 2]' '[1,]' '{"a":}' '{"a" 1}' '{a: 1}' '{"a": 1,}' \
    '{"a": 1, "a": 2}'; do
    member "comment: $text" "\"comment\": $text"
  done
  member 'a key that is no text' '1: 1'
  member 'a key twice' "$first: 1"
  member 'a hash for a comment' '# x\n"comment": 1'
  member 'keys that steer the terminal' '"\\u001b[31m\\u009b\\u202e\\n": [], "\\u001b": 1,  "comment": NaN'
  document 'arrays nested 100000 deep' refused < <(printf '{"comment": '; repeat '[' 100000; repeat ']' 100000; printf ','; echo "$rest")
  document 'objects nested without end' refused < <(for _ in {1..2000}; do printf '{"a":'; done)
  document 'a number of 1 MB' refused < <(printf '{"comment": 1'; repeat 0 1000000; printf ','; echo "$rest")
  if [[ $whose == user ]]; then
    document 'comments' accepted < <(printf '// x\n{/* y */'; echo "$rest")
    document '100000 unknown keys' refused < <(printf '{'; many_keys; echo "$rest")
  else
    document 'comments' refused < <(printf '// x\n'; cat sound)
  fi
  rm "$file"; truncate -s 100M "$file"; judge refused "$reader" "$file" '100 MB of nothing'
  cp sound "$file"
done

# tables: a series, strains, spheres by themselves, the curve of a prediction in its folder
for entry in "check scene/series/series.csv" "check scene/strain/strain.csv" "check scene/spheres/spheres.csv" \
  "report law/predictions/p/reduced-law.csv"; do
  read -r reader file <<<"$entry"
  cp "$file" sound
  table() { cat >"$file"; judge "$2" "$reader" "$file" "$1"; }
  header=$(head -1 sound) row=$(sed -n 2p sound)
  table 'no line end at the end' accepted < <(head -c -1 sound)
  table 'CRLF' accepted < <(sed 's/$/\r/' sound)
  table nothing refused </dev/null
  table 'a header that is quoted' refused < <(sed '1s/\([^,]*\)/"\1"/g' sound)
  table 'a column twice' refused < <(sed 's/^\([^,]*\),/\1,\1,/' sound)
  table 'a field too few' refused < <(sed '2s/,[^,]*$//' sound)
  table 'a field too many' refused < <(sed '2s/$/,1/' sound)
  table 'decimal commas' refused < <(sed '2,$s/\./,/g' sound)
  table semicolons refused < <(tr , ';' <sound)
  table tabs refused < <(tr , '\t' <sound)
  table 'a NUL byte' refused < <(cat sound; printf '\0\n')
  table 'UTF-16' refused < <(sed 's/./&\x00/g' sound)
  table 'a line of 100 MB' refused < <(cat sound; repeat 1 100000000; echo)
  table '1000000 columns' refused < <(echo "$header$(repeat , 1000000)"; cat sound)
  table '1000000 fields' refused < <(cat sound; echo "$row$(repeat , 1000000)")
  table 'a header that steers the terminal' refused < <(printf '\x1b[31m\xc2\x9b\xe2\x80\xae,'; cat sound)
  table 'a line between the rows that is empty' refused < <(sed '2s/$/\n/' sound)
  for text in nan inf -inf 1e999 0x10 1_000 1.5.2 --1 +1 1,5 '"1"' x '\x1b[31m' '1\r'; do
    table "the number $text" refused < <(sed "3s/^[^,]*/$(printf '%b' "$text" | sed 's/[\\/&]/\\&/g')/" sound)
  done
  cp sound "$file"
done
exit 0
