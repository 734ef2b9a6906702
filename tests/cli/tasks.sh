# Many processes in one store: tasks of one list at once, some killed, locks of the dead and of other machines. The result is that of
# one process, digit for digit, and no run is made twice.
set -euo pipefail
grainlaw=$(realpath "$1")
fail() { echo "FAIL: $*" >&2; exit 1; }
set -m  # background jobs keep SIGINT

cat >spec.json <<'JSON'
{"particles": 150, "seeds": [1, 2, 3], "strain_rate": 3000, "rows": 30, "densities": [0.70, 0.74, 0.78],
 "tests": [{"mode": "ISO", "role": "calibration"}, {"mode": "D2", "role": "calibration"}]}
JSON
calibrate() { "$grainlaw" calibrate spec.json "$@" || [[ $? == 3 ]]; }  # so few spheres need not make a law
calibrate -o alone --quiet >/dev/null

# the list: what calibrate simulates, longest first; without --array nothing is written
"$grainlaw" runs spec.json -o out --json >list.json
[[ ! -e out ]] || fail "runs wrote something"
jq -e '.runs == 12 and .runs_found == 0 and .tasks == 0 and ([.list[].particle_steps] | . == (sort | reverse)) and (.list | all(.state == "missing"))' \
  list.json >/dev/null || fail "list: $(cat list.json)"
diff <(jq -r '.list[].key' list.json | sort) <(ls alone/runs | sort) || fail "the list is not what calibrate has simulated"
[[ $("$grainlaw" runs spec.json -o alone | head -1) == '12 runs, 12 finished, 0 being made, 0 missing: 0 particle-steps' ]] || fail "all are finished"
! "$grainlaw" task out 1 2>err && grep -q 'tasks.json: not found; grainlaw runs SPEC -o out --array N writes it' err || fail "task without a list: $(cat err)"
[[ ! -e out ]] || fail "a refused task left a folder"
"$grainlaw" runs spec.json -o out --array 4 --json >dealt.json
diff <(jq '[.list[] | {key, name, particle_steps}] | sort_by(.key)' list.json) <(jq '[.list[] | {key, name, particle_steps}] | sort_by(.key)' dealt.json) ||
  fail "dealing changes the list"
[[ $(jq '[.list[].task] | unique' -c dealt.json) == '[1,2,3,4]' ]] || fail "tasks: $(jq '[.list[].task]' -c dealt.json)"
work=$(jq '[.list | group_by(.task)[] | map(.particle_steps) | add] | max / min' dealt.json)
awk -v r="$work" 'BEGIN { exit !(r < 2) }' || fail "most over least of the tasks' work: $work"

finished() { find out/runs -ignore_readdir_race -mindepth 2 -name run.json -printf '%p %i %T@\n' 2>/dev/null | sort; }
made() { jq -s 'map(.runs - .runs_found - .runs_of_others) | add' "$@"; }

# one is killed amid its first run: a lock is left, the next process takes it over at once and goes on from the checkpoint
"$grainlaw" task out 2 --threads 1 --checkpoint 0 --json >killed.json 2>/dev/null &
pid=$!
for ((i = 0; i < 1000; ++i)); do
  [[ -n $(find out/runs -name checkpoint.previous 2>/dev/null) ]] && break
  sleep 0.01
done
kill -9 $pid 2>/dev/null || fail "the task ended before it could be killed"
wait $pid 2>/dev/null || true
[[ -z $(finished) && $(ls -d out/runs/*.lock | wc -l) == 1 ]] || fail "after the kill: $(ls out/runs)"

# another is on a machine that is heard of, one on a machine that is silent
key() { jq -r --arg name "$1" '.list[] | select(.name == $name).key' dealt.json; }
lock() { mkdir -p "out/runs/$(key "$1").lock" && touch -d "$2" "out/runs/$(key "$1").lock/node7,$3,1,elsewhere,0"; }
lock D2-0.70-s1 now 11
lock D2-0.74-s3 '10 minutes ago' 12
"$grainlaw" runs spec.json -o out >listed.txt
[[ $(head -1 listed.txt) == '12 runs, 0 finished, 1 being made, 11 missing: '* ]] && grep -q ' made .*D2-0.70-s1$' listed.txt || fail "$(cat listed.txt)"

# all tasks at once, twice each, and a calibration that waits for them
calibrate -o out --wait --json >waited.json 2>waited.log &
waiting=$!
for task in 1 2 3 4; do
  for who in a b; do "$grainlaw" task out $task --threads 1 --json >"task-$task$who.json" 2>"task-$task$who.log" & done
done
tasks=$(jobs -p | grep -v "^$waiting$")
told() { grep -qs 'D2-0.70-s1: is made by process 11 on node7' task-*.log; }
for ((i = 0; i < 1200; ++i)); do
  (( $(finished | wc -l) == 11 )) && told && break  # a task asks for what another makes once a second
  sleep 0.05
done
told || fail "nobody waits for the other machine: $(cat task-*.log)"
[[ ! -e out/runs/$(key D2-0.70-s1)/run.json && ! -e out/parameters.json ]] || fail "a run was made against its lock"
finished >before
rm -r "out/runs/$(key D2-0.70-s1).lock"
for pid in $tasks; do wait "$pid" || fail "a task ended with $?: $(cat task-*.log)"; done
wait $waiting || fail "the calibration that waits: $(cat waited.log)"
grep -q 'goes on from the checkpoint at step' task-*.log || fail "the killed run began anew: $(cat task-*.log)"
[[ $(made task-*.json) == 12 ]] || fail "$(made task-*.json) runs were made, not 12"
[[ -z $(finished | comm -13 - before) ]] || fail "a finished run was made again"
[[ $(jq '.runs_found' waited.json) != 12 ]] || fail "the calibration did not wait"
grep -q 'of 12 runs are made by nobody now: \|of 12 runs are being made: ' waited.log || fail "nothing is named: $(cat waited.log)"
[[ -z $(find out -name '*.lock*' -o -name 'checkpoint*') ]] || fail "left over: $(find out -name '*.lock*' -o -name 'checkpoint*')"

# digit for digit
bare() { jq 'del(.provenance)' "$1"; }
diff <(bare alone/parameters.json) <(bare out/parameters.json) || fail "other parameters than one process makes"
diff <(cd alone/dataset && sha256sum *.csv) <(cd out/dataset && sha256sum *.csv) || fail "another data set"

# single runs by name and key, with their preparation; a task that is told to end leaves a checkpoint and no lock
"$grainlaw" runs spec.json -o named --array 1 >/dev/null
"$grainlaw" task named D2-0.74-s2 "$(key D2-0.78-s2 | head -c 10)" --json >named.json
[[ $(jq -c '[.runs, .runs_found]' named.json) == '[3,0]' ]] || fail "by name: $(cat named.json)"
! "$grainlaw" task named D2-0.74-s9 2>err && grep -q "has no task, run or key 'D2-0.74-s9'" err || fail "$(cat err)"
"$grainlaw" task named 1 --threads 1 --checkpoint 1e6 >stdout 2>log &
pid=$!
for ((i = 0; i < 500; ++i)); do [[ -n $(ls -d named/runs/*.lock 2>/dev/null) ]] && break; sleep 0.01; done
kill -TERM $pid
code=0
wait $pid || code=$?
[[ $code == 130 && -z $(ls -d named/runs/*.lock 2>/dev/null) ]] || fail "SIGTERM: $code, $(ls named/runs), $(cat log)"

# what a calibration waits for is named when it is interrupted, too; it leaves nothing
"$grainlaw" calibrate spec.json -o nothing --wait 2>log &
pid=$!
named() { grep -c '12 of 12 runs are made by nobody now: preparation-s1, ' log; }
for ((i = 0; i < 1000; ++i)); do [[ $(named) == 1 ]] && break; sleep 0.01; done
kill -INT $pid
code=0
wait $pid || code=$?
[[ $code == 130 && $(named) == 2 && ! -e nothing ]] || fail "--wait: $code, $(cat log)"

# two calibrations in one folder share the runs, and each ends with the whole result
for who in a b; do calibrate -o shared --threads 1 --json >"shared-$who.json" 2>"shared-$who.log" & done
wait %?shared-a 2>/dev/null || true
wait || fail "two calibrations: $(cat shared-*.log)"
[[ $(jq -s 'map(.runs - .runs_found - .runs_of_others) | add' shared-?.json) == 12 ]] || fail "shared: $(cat shared-?.json)"
diff <(bare alone/parameters.json) <(bare shared/parameters.json) || fail "two calibrations make other parameters"

# submit --dry-run: scripts that bash reads, tasks that are not finished, names with all that a shell minds
dir="it's a \$(folder)"
"$grainlaw" runs spec.json -o "$dir" --array 3 >/dev/null
"$grainlaw" task "$dir" 2 --quiet >/dev/null
"$grainlaw" submit --slurm --dry-run --account geo --time 1:00:00 --sbatch=--mem=1G --sbatch=--qos=low "$dir" --json >submit.json
[[ $(jq -c '[.tasks, .jobs, (.scripts | length)]' submit.json) == '[[1,3],[],2]' ]] || fail "submit: $(cat submit.json)"
for script in "$dir"/tasks/*.sbatch; do bash -n "$script" || fail "$script"; done
grep -q '^#SBATCH --array=1,3$' "$dir/tasks/tasks.sbatch" && grep -q '^#SBATCH --account=geo$' "$dir/tasks/tasks.sbatch" &&
  grep -q '^#SBATCH --mem=1G$' "$dir/tasks/calibration.sbatch" || fail "directives: $(cat "$dir/tasks/tasks.sbatch")"
SLURM_ARRAY_JOB_ID=7 SLURM_ARRAY_TASK_ID=3 bash "$dir/tasks/tasks.sbatch"
"$grainlaw" runs spec.json -o "$dir" --json | jq -e '[.list[] | select(.state == "finished")] | length >= 8' >/dev/null ||
  fail "the script made nothing: $(cat "$dir/tasks/task-3.log")"
for arguments in "" "--slurm --account a#b" "--slurm --array 0"; do
  code=0
  "$grainlaw" submit "$dir" $arguments >/dev/null 2>err || code=$?
  [[ $code == 2 ]] || fail "submit $arguments: $code $(cat err)"
done
