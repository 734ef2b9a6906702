# "engine": "lammps": the same packing seen alike, a test with friction from its own preparation, what is refused, LAMMPS's
# death, interruption and resuming. The parts that need lmp are skipped, and said to be, where there is none.
set -euo pipefail
grainlaw=$1
fail() { echo "FAIL: $*" >&2; exit 1; }
set -m  # background jobs keep SIGINT
small='"particles": 200, "seed": 3, "strain_rate": 5000, "rows": 10, "nu_end": 0.72'
refused() { # FILE WORDS OPTION...: exit 2 with these words, and nothing is written
  local file=$1 words=$2 code=0
  shift 2
  "$grainlaw" simulate "$file" -o refused "$@" 2>err || code=$?
  [[ $code == 2 && ! -e refused ]] && grep -qF -- "$words" err || fail "$file $*: exit code $code, $(cat err)"
}

# --- without LAMMPS
echo "{$small, \"friction\": 0.5}" >friction.json
refused friction.json "friction: the engine 'grainlaw' does not have it"
echo "{$small, \"normal_force\": \"hertz\"}" >hertz.json
refused hertz.json "normal_force: the engine 'grainlaw' does not have it"
echo "{$small, \"engine\": \"lammps\", \"cohesion\": 1}" >cohesion.json
refused cohesion.json "cohesion: is that of Derjaguin"
echo "{$small, \"engine\": \"lammps\", \"rolling_friction\": 0.1}" >rolling.json
refused rolling.json "rolling_friction: spheres that slide"
echo "{$small, \"engine\": \"lammps\", \"precision\": \"double\"}" >precision.json
refused precision.json "precision: belongs to the engine 'grainlaw'"
for key in '"frames": 3' '"probes": {"every": 0.1}'; do
  echo "{$small, \"engine\": \"lammps\", $key, \"initial\": {\"nu\": 0.74}, \"segments\": [{\"mode\": \"D2\", \"extent\": {\"eps_dev\": 0.1}}]}" >ours_alone.json
  refused ours_alone.json "belongs to the engine 'grainlaw'"
done
echo "{$small, \"engine\": \"lammps\", \"initial\": {\"nu\": 0.74}, \"segments\": [{\"mode\": \"D2\", \"extent\": {\"eps_dev\": 0.1}}]}" >ours_alone.json
refused ours_alone.json "ours_alone.json: --frames: belongs to the engine 'grainlaw'" --frames 3 --dry-run
echo "{$small, \"engine\": \"lammps\"}" >lammps.json
refused lammps.json "no executable './nowhere/lmp'" --lammps ./nowhere/lmp
refused lammps.json "does not say that it is LAMMPS" --lammps true
refused lammps.json "does not say that it is LAMMPS" --lammps false
refused lammps.json "no executable 'nosuchlmp' on PATH" --lammps nosuchlmp
printf '#!/bin/sh\necho "Large-scale Atomic/Molecular Massively Parallel Simulator - 1 Jan 2030"\necho " KSPACE MISC "\n' >plain
chmod +x plain
refused lammps.json "(1 Jan 2030) is built without the package GRANULAR" --lammps ./plain

if ! command -v lmp >/dev/null; then
  echo "SKIPPED: lmp is not installed (Debian package lammps); what is refused was tested, nothing that runs it" >&2
  exit 77
fi
refused lammps.json "--launcher: no executable 'nolauncher'" --launcher "nolauncher -n 2"

# --- the same spheres: stress of the first row to 1e-12; the end of a short shear, of the same path at the same rate, alike
column() { # FILE NAME ROW(1: first, else last)
  awk -F, -v name="$2" -v row="$3" 'NR == 1 { for (i = 1; i <= NF; ++i) { t = $i; sub(/\[.*/, "", t); if (t == name) c = i } }
    { if (NR == 2 && row == 1) { print $c; exit } last = $c } END { if (row != 1) print last }' "$1"
}
echo "{$small, \"initial\": {\"nu\": 0.78}, \"segments\": [{\"mode\": \"D2\", \"extent\": {\"eps_dev\": 0.02}}]}" >ours.json
"$grainlaw" simulate ours.json -o packing --quiet >/dev/null
state=$(find packing/runs -name 'unloading-0.78.state')
echo "{\"state\": \"$state\", \"rows\": 10, \"strain_rate\": 500, \"segments\": [{\"mode\": \"D2\", \"extent\": {\"eps_dev\": 0.02}},
  {\"mode\": \"UNI\", \"extent\": {\"eps_dev\": 0.004}}]}" >same.json
jq '.precision = "double"' same.json >double.json
"$grainlaw" simulate double.json -o same --quiet >/dev/null
jq '.engine = "lammps"' same.json >theirs.json
"$grainlaw" simulate theirs.json -o theirs --json --quiet >theirs.json.out
for axis in xx yy zz; do
  awk -v a="$(column same/series.csv stress_$axis 1)" -v b="$(column theirs/series.csv stress_$axis 1)" \
    'BEGIN { exit !((a - b)^2 <= 1e-24 * a^2 && a != 0) }' || fail "stress_$axis of the first row"
done
for name in P_star nu F_v C_star eps_dev eps_vol shear_path time; do
  awk -v a="$(column same/series.csv $name 0)" -v b="$(column theirs/series.csv $name 0)" \
    'BEGIN { exit !((a - b)^2 <= (0.02 * a)^2) }' \
    || fail "$name at the end: $(column same/series.csv $name 0) and $(column theirs/series.csv $name 0)"
done
[[ $(jq -r .run same/simulation.json) != $(jq -r .run theirs/simulation.json) ]] || fail "one key for both engines"
record=$(find theirs/runs -name run.json)
jq -e '.provenance.lammps.version | test("^[0-9]+ [A-Z][a-z]+ [0-9]+")' "$record" >/dev/null || fail "$(jq .provenance "$record")"
[[ -z $(find theirs -name '.lammps') ]] || fail "scratch files stay"

# --- friction from its own preparation: the springs are handed on, the record says so; a second call runs nothing
echo "{$small, \"engine\": \"lammps\", \"friction\": 0.5, \"rolling_friction\": 0.1, \"initial\": {\"nu\": 0.74},
  \"segments\": [{\"mode\": \"D2\", \"extent\": {\"eps_dev\": 0.02}}, {\"mode\": \"D2\", \"reverse\": true, \"extent\": {\"eps_dev\": 0.02}}]}" >rough.json
"$grainlaw" simulate rough.json -o rough --quiet >/dev/null
jq -e '.packing.friction == 0.5 and .packing.rolling_friction == 0.1' rough/simulation.json >/dev/null || fail "$(jq .packing rough/simulation.json)"
[[ -n $(find rough/runs -name 'unloading-0.74.restart') ]] || fail "no springs are kept"
(( $(wc -l <rough/series.csv) == 22 )) || fail "rows"
before=$(find rough/runs -name run.json -printf '%p %T@\n' | sort)
"$grainlaw" simulate rough.json -o rough --quiet --lammps ./nowhere/lmp >/dev/null || fail "finished runs need no LAMMPS"
[[ $(find rough/runs -name run.json -printf '%p %T@\n' | sort) == "$before" ]] || fail "finished runs were repeated"

# springs survive the restart files on the way: states that are kept come to rest, which they do not where springs are mixed up
echo "{\"engine\": \"lammps\", \"friction\": 0.3, \"particles\": 200, \"seed\": 5, \"strain_rate\": 1500, \"rows\": 10, \"nu_end\": 0.66,
  \"keep\": [{\"nu\": 0.7}, {\"nu\": 0.75}, {\"nu\": 0.68, \"branch\": \"loading\"}, {\"nu\": 0.8, \"branch\": \"loading\"}]}" >keep.json
"$grainlaw" simulate keep.json -o "ke ep" --quiet >/dev/null
jq -e '[.states[].relaxation.relaxed] == [true, true, true, true]' "ke ep/simulation.json" >/dev/null || fail "$(jq -c .states "ke ep/simulation.json")"

# --- other normal forces: each force is held against its law while it is read
echo "{\"state\": \"$state\", \"engine\": \"lammps\", \"normal_force\": \"hertz\", \"cohesion\": 5000, \"rows\": 5,
  \"strain_rate\": 5000, \"segments\": [{\"mode\": \"ISO\", \"extent\": {\"target_nu\": 0.80}}]}" >sticky.json  # pulls with 5 % of a force
"$grainlaw" simulate sticky.json -o sticky --quiet >/dev/null
jq -e '.packing.normal_force == "hertz" and .packing.cohesion == 5000' sticky/simulation.json >/dev/null || fail "$(jq .packing sticky/simulation.json)"
jq 'del(.cohesion) | .friction = 0.2' sticky.json >hertz.json
"$grainlaw" simulate hertz.json -o hertz --quiet >/dev/null
awk -v a="$(column sticky/series.csv P_star 1)" -v b="$(column hertz/series.csv P_star 1)" 'BEGIN { exit !(a < 0.97 * b && a > 0.5 * b) }' \
  || fail "P* with and without cohesion: $(column sticky/series.csv P_star 1), $(column hertz/series.csv P_star 1)"
# what is exported are the forces of these contacts, whose sum is the stress; those of friction are in no state
"$grainlaw" export sticky/end.state --format csv -o exported >/dev/null
volume=$(jq '.cell | .[0][0] * .[1][1] * .[2][2]' sticky/simulation.json)
sum=$(awk -F, 'NR > 1 { s += $3 * $6 + $4 * $7 + $5 * $8 } END { printf "%.12g", s }' exported/end.contacts.csv)
P=$(for c in xx yy zz; do column sticky/series.csv "stress_$c" 0; done | awk '{ s += $1 } END { printf "%.12g", s }')
awk -v s="$sum" -v V="$volume" -v P="$P" 'BEGIN { exit !((s / V - P)^2 <= (0.01 * P)^2 && P > 0) }' || fail "stress of exported forces: $sum / $volume, $P"
! "$grainlaw" export hertz/end.state --format csv -o exported 2>err || fail "forces without friction were exported"
grep -q 'was made with friction' err || fail "$(cat err)"
jq 'del(.engine, .normal_force, .cohesion) | .state = "sticky/end.state"' sticky.json >other.json
! "$grainlaw" simulate other.json -o other 2>err || fail "a state of other contacts was driven by k delta"
grep -q 'was made with other contacts' err || fail "$(cat err)"

# a LAMMPS that means something else by its commands (here: twice the stiffness) is found out
cat >liar <<'SH'
#!/usr/bin/env bash
[[ $1 == -h ]] && exec lmp -h
sed -i 's/hooke 100000000/hooke 200000000/' "$2"
exec lmp "$@"
SH
cat >dying <<'SH'
#!/usr/bin/env bash
# LAMMPS that is killed after some rows of a test
[[ $1 == -h ]] && exec lmp -h
[[ $2 == test.in && ! -e ../../../../died ]] || exec lmp "$@"
lmp "$@" & pid=$!
while (( $(cat marks 2>/dev/null | wc -l) < 7 )); do sleep 0.02; done
touch ../../../../died
kill -9 $pid
wait $pid
SH
cat >cut <<'SH'
#!/usr/bin/env bash
# LAMMPS on a full disk: its dumps end early, and it does not notice
[[ $1 == -h ]] && exec lmp -h
trap '' XFSZ
ulimit -f 64  # enough for a restart file of 200 spheres
export OMPI_MCA_btl=self PMIX_MCA_gds=hash  # no files of MPI's own
exec lmp "$@"
SH
chmod +x liar dying cut
code=0
"$grainlaw" simulate theirs.json -o liar.out --lammps ./liar --quiet 2>err || code=$?
[[ $code == 1 ]] && grep -q "off the law that it was asked for" err || fail "a liar: exit code $code, $(cat err)"

# --- death half-way: a message with the log's last lines, then on from the last row
jq '.strain_rate = 250 | .rows = 20' theirs.json >long.json
code=0
"$grainlaw" simulate long.json -o dead --lammps ./dying 2>err || code=$?
[[ $code == 1 ]] && grep -q "LAMMPS ended with exit code 137: " err || fail "death: exit code $code, $(cat err)"
"$grainlaw" simulate long.json -o dead --lammps ./dying 2>err >/dev/null || fail "after death: $(cat err)"
grep -q "went on from LAMMPS's restart file at step" err || fail "resumed from nowhere: $(cat err)"
(( $(wc -l <dead/series.csv) == 42 )) || fail "rows after resuming: $(wc -l <dead/series.csv)"
"$grainlaw" simulate long.json -o whole --quiet >/dev/null
for name in P_star time eps_dev; do
  awk -v a="$(column whole/series.csv $name 0)" -v b="$(column dead/series.csv $name 0)" 'BEGIN { exit !((a - b)^2 <= (0.02 * a)^2) }' \
    || fail "$name after resuming: $(column dead/series.csv $name 0), without: $(column whole/series.csv $name 0)"
done
jq -e '.warnings[0] | test("went on from")' dead/simulation.json >/dev/null || fail "no warning of it"

# --- a full disk
code=0
"$grainlaw" simulate long.json -o full --lammps ./cut --quiet 2>err || code=$?
[[ $code == 1 ]] && grep -q "is the disk full" err || fail "full disk: exit code $code, $(cat err)"

# --- Ctrl-C: LAMMPS is gone, the next call goes on
"$grainlaw" simulate long.json -o stopped 2>log >/dev/null & pid=$!
for ((i = 0; i < 300; ++i)); do
  (( $(cat stopped/runs/*/.lammps/marks 2>/dev/null | wc -l) >= 5 )) && break
  kill -0 $pid 2>/dev/null || fail "ended by itself: $(cat log)"
  sleep 0.02
done
lmp_pid=$(ps -o pid= --ppid $pid | tr -d ' ')
kill -INT $pid
code=0
wait $pid || code=$?
[[ $code == 130 ]] || fail "SIGINT: exit code $code, $(cat log)"
! kill -0 $lmp_pid 2>/dev/null || fail "LAMMPS lives on"
"$grainlaw" simulate long.json -o killed --quiet >/dev/null 2>&1 & pid=$!
for ((i = 0; i < 300; ++i)); do (( $(cat killed/runs/*/.lammps/marks 2>/dev/null | wc -l) >= 2 )) && break; sleep 0.02; done
lmp_pid=$(ps -o pid= --ppid $pid | tr -d ' ')
kill -9 $pid
wait $pid 2>/dev/null || true
for ((i = 0; i < 100; ++i)); do kill -0 $lmp_pid 2>/dev/null || break; sleep 0.05; done
! kill -0 $lmp_pid 2>/dev/null || fail "LAMMPS outlives the death of its parent"
"$grainlaw" simulate long.json -o stopped 2>log >/dev/null || fail "after SIGINT: $(cat log)"
grep -q "went on from LAMMPS's restart file" log || fail "did not go on: $(cat log)"
(( $(wc -l <stopped/series.csv) == 42 )) || fail "rows after SIGINT"
# --- two ranks
if command -v mpirun >/dev/null; then
  OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "$grainlaw" simulate theirs.json -o ranks --quiet \
    --launcher "mpirun --oversubscribe -n 2" >/dev/null || fail "two ranks"
  awk -v a="$(column theirs/series.csv P_star 0)" -v b="$(column ranks/series.csv P_star 0)" 'BEGIN { exit !((a - b)^2 <= (0.02 * a)^2) }' || fail "P* of two ranks"
fi
