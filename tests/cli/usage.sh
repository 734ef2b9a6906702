# Help, version, usage errors, exit codes, what goes to which stream.
set -euo pipefail
grainlaw=$1
fail() { echo "FAIL: $*" >&2; exit 1; }
code_of() { local code=0; "$@" >out 2>err || code=$?; echo "$code"; }

[[ $(code_of "$grainlaw" --version) == 0 ]] && grep -Eq '^grainlaw [0-9]+\.[0-9]+\.[0-9]+ \(.+\)$' out || fail version
[[ $(code_of "$grainlaw" --help) == 0 && ! -s err ]] || fail help
for command in init check simulate calibrate runs task submit predict report study completion man; do
  grep -q "^  $command " out || fail "help does not list $command"
done
for command in simulate calibrate predict report "study integrator" "study dem" "study fit" "study chain" "study prior"; do
  [[ $(code_of "$grainlaw" $command --help) == 0 && ! -s err ]] || fail "$command --help"
  tr '\n' ' ' <out | grep -q 'Exit codes: 0 ok, 1 failure, 2 invalid input or usage, 3 did not converge, 130 interrupted' ||
    fail "$command: exit codes"
  for option in --threads --json --quiet; do grep -q -- "$option" out || fail "$command: $option"; done
done
for arguments in "nonsense" "calibrate" "calibrate -o out" "calibrate a b -o out" "simulate x.json" "predict p.json -o out" \
    "calibrate x.json -o out --threads 0" "calibrate x.json -o out --threads x" "calibrate x.json -o out --wrong" \
    "predict a b -o out --model best" "predict a b -o out --initial best" "calibrate x.json -o out --coupling none" \
    "study integrator" "completion csh" "init all" "check" "study nothing -o out" "study fit -o out" "study chain x.json -o out --vary rows=9" "study integrator -o out --repeats 0"; do
  [[ $(code_of "$grainlaw" $arguments) == 2 ]] || fail "'$arguments' must exit 2"
  [[ ! -s out && $(wc -l <err) == 1 ]] || fail "'$arguments' must say one line on stderr: $(cat err)"
  [[ ! -e out.d && ! -d out ]] || fail "'$arguments' left a folder"
done
# alone, and where a command of several is missing: the way on, on stderr, as nothing was done
for arguments in "" study; do
  [[ $(code_of "$grainlaw" $arguments) == 2 && ! -s out ]] || fail "'$arguments' must exit 2"
done
[[ $(code_of "$grainlaw") == 2 ]] && grep -q 'grainlaw init spec' err && grep -q '^  calibrate ' err || fail "$(cat err)"
# help says the same as --help, --version goes with every command, no help is wider than 80 columns or shows numbers of choices
for command in "" init check simulate calibrate runs task submit predict report study "study dem" "study chain" completion man; do
  "$grainlaw" $command --help >wanted
  [[ $(code_of "$grainlaw" help $command) == 0 ]] && cmp -s wanted out || fail "help $command"
  (( $(LC_ALL=C.UTF-8 wc -L <out) <= 80 )) || fail "help $command is wider than 80 columns"
  ! grep -qE -- '->|\bOR\b|\{' out || fail "$command: choices are not words: $(grep -E -- '->|OR' out)"
  [[ $(code_of "$grainlaw" $command --version) == 0 ]] && grep -q '^grainlaw [0-9]' out || fail "$command --version"
done
"$grainlaw" help predict | grep -q -- '--model reduced|evolution|memory' || fail "the rungs are not named"
# slips of the hand
slip() { # EXPECTED ARGUMENT...
  [[ $(code_of "$grainlaw" "${@:2}") == 2 && $(wc -l <err) == 1 ]] && grep -Fq -- "$1" err || fail "${*:2}: $(cat err)"
}
slip "unknown command 'calibrat'; did you mean calibrate?" calibrat x.json -o out
slip "unknown command 'intergrator'; did you mean integrator?" study intergrator -o out
slip "unknown command 'xyzzy'; there are init, check, simulate" xyzzy
slip "unknown option '--tread'; did you mean --threads?" calibrate x.json -o out --tread 2
slip "unknown option '--xyzzy'; see grainlaw calibrate --help" calibrate x.json -o out --xyzzy=3
slip "--model: got 'memry'; did you mean memory?" predict a b -o out --model memry
slip "--initial: got 'best'; give law or measured" predict a b -o out --initial best
slip "--threads: got '0'; give a number, 1 to 1024" calibrate x.json -o out --threads 0
slip "unknown command 'calibrat'" help calibrat
for seeds in 5-3 1- -4 1,,2 x 1-2000 ''; do slip '--seeds' predict a b -o out "--seeds=$seeds"; done
# a variable of the shell that is not set
slip "--output: is empty; is a variable of the shell not set?" predict a b -o ""
slip "PATH: is empty; is a variable of the shell not set?" predict a "" -o out
slip "is empty; is a variable of the shell not set?" check ""
# a result that cannot be written is no success
if [[ -w /dev/full ]]; then
  echo '{"spheres": "s.csv", "cell": [[0.01,0,0],[0,0.01,0],[0,0,0.01]]}' >t.json
  printf 'id,x,y,z,r\n0,0.001,0.001,0.001,0.001\n1,0.005,0.001,0.001,0.001\n' >s.csv
  code=0
  "$grainlaw" help calibrate >/dev/full 2>err || code=$?
  [[ $code == 1 ]] && grep -q 'standard output: cannot be written' err || fail "help to /dev/full: $code $(cat err)"
  code=0
  "$grainlaw" simulate t.json -o two --quiet >/dev/full 2>err || code=$?
  [[ $code == 1 ]] && grep -q 'standard output: cannot be written' err || fail "/dev/full: $code $(cat err)"
fi
