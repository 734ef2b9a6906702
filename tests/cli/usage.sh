# Help, version, usage errors, exit codes, what goes to which stream.
set -euo pipefail
grainlaw=$1
fail() { echo "FAIL: $*" >&2; exit 1; }
code_of() { local code=0; "$@" >out 2>err || code=$?; echo "$code"; }

[[ $(code_of "$grainlaw" --version) == 0 ]] && grep -Eq '^grainlaw [0-9]+\.[0-9]+\.[0-9]+ \(.+\)$' out || fail version
[[ $(code_of "$grainlaw" --help) == 0 && ! -s err ]] || fail help
for command in simulate calibrate predict report study; do
  grep -q "^  $command " out || fail "help does not list $command"
done
for command in simulate calibrate predict report "study integrator" "study dem" "study fit" "study chain" "study prior"; do
  [[ $(code_of "$grainlaw" $command --help) == 0 && ! -s err ]] || fail "$command --help"
  grep -q 'Exit codes: 0 ok, 1 failure, 2 invalid input or usage, 3 did not converge, 130 interrupted' out || fail "$command: exit codes"
  for option in --threads --json --quiet; do grep -q -- "$option" out || fail "$command: $option"; done
done
for arguments in "" "nonsense" "calibrate" "calibrate -o out" "calibrate a b -o out" "simulate x.json" "predict p.json -o out" \
    "calibrate x.json -o out --threads 0" "calibrate x.json -o out --threads x" "calibrate x.json -o out --wrong" \
    "predict a b -o out --model best" "predict a b -o out --initial best" "calibrate x.json -o out --coupling none" \
    "study" "study integrator" "study nothing -o out" "study fit -o out" "study chain x.json -o out --vary rows=9" "study integrator -o out --repeats 0"; do
  [[ $(code_of "$grainlaw" $arguments) == 2 ]] || fail "'$arguments' must exit 2"
  [[ ! -s out && $(wc -l <err) == 1 ]] || fail "'$arguments' must say one line on stderr: $(cat err)"
  [[ ! -e out.d && ! -d out ]] || fail "'$arguments' left a folder"
done
# a result that cannot be written is no success
if [[ -w /dev/full ]]; then
  echo '{"spheres": "s.csv", "cell": [[0.01,0,0],[0,0.01,0],[0,0,0.01]]}' >t.json
  printf 'id,x,y,z,r\n0,0.001,0.001,0.001,0.001\n1,0.005,0.001,0.001,0.001\n' >s.csv
  code=0
  "$grainlaw" simulate t.json -o two --quiet >/dev/full 2>err || code=$?
  [[ $code == 1 ]] && grep -q 'standard output: cannot be written' err || fail "/dev/full: $code $(cat err)"
fi
