# SIGINT and SIGTERM: exit 130 soon, finished runs stay and are not repeated; a second process leaves the run in progress alone.
set -euo pipefail
grainlaw=$1
fail() { echo "FAIL: $*" >&2; exit 1; }
set -m  # background jobs keep SIGINT

# a short preparation (finished) and then tests that would take minutes
cat >spec.json <<'JSON'
{"particles": 64, "seeds": [1], "strain_rate": 5000, "rows": 20, "densities": [0.78], "nu_end": 0.76,
 "tests": [{"mode": "ISO", "role": "calibration"}, {"mode": "D2", "strain": 0.01, "role": "calibration"},
           {"name": "long", "segments": [{"mode": "D2", "extent": {"eps_dev": 100}}], "role": "validation"}]}
JSON
finished() { find out/runs -mindepth 2 -name run.json 2>/dev/null | wc -l; }
for signal in INT TERM; do
  "$grainlaw" calibrate spec.json -o out >stdout 2>log &
  pid=$!
  for ((i = 0; i < 600; ++i)); do
    (( $(finished) >= 2 )) && compgen -G 'out/runs/*.lock' >/dev/null && break
    kill -0 $pid 2>/dev/null || fail "ended by itself: $(cat log)"
    sleep 0.1
  done
  rm -f other  # of the signal before: what it says would be taken for the second process's word
  "$grainlaw" calibrate spec.json -o out >/dev/null 2>other &
  second=$!
  for ((i = 0; i < 300; ++i)); do grep -qs 'long.*: is made by process' other && break; sleep 0.1; done
  kill -$signal $second
  code=0
  wait $second || code=$?
  [[ $code == 130 ]] && grep -q "long.*: is made by process $pid on " other || fail "two processes in one store: $code $(cat other)"
  kill -$signal $pid
  sleep 0.02
  kill -$signal $pid 2>/dev/null || true  # as timeout(1) and mpirun do: the process and its group, one wish
  code=0
  wait $pid || code=$?
  [[ $code == 130 ]] || fail "SIG$signal: exit code $code: $(cat log)"
  tail -1 log | grep -q 'grainlaw: interrupted' || fail "no word of it: $(tail -1 log)"
  (( $(finished) == 2 )) || fail "$(finished) finished runs, not 2"
  [[ ! -e out/parameters.json && ! -e out/dataset/dataset.json ]] || fail "results of an unfinished calibration"
done
# waiting for what nobody writes or reads, too
mkfifo nobody
code=0  # not where a file is read more than once
timeout 10 "$grainlaw" check nobody >stdout 2>log || code=$?
[[ $code == 2 ]] && grep -q 'nobody: is no regular file' log stdout || fail "check of a FIFO: exit code $code, $(cat log stdout)"
for command in "calibrate nobody -o none" "completion bash -o nobody"; do
  "$grainlaw" $command >stdout 2>log &
  pid=$!
  for ((i = 0; i < 100; ++i)); do  # until SIGINT (bit 1) is caught, and some more until it waits
    caught=$(awk '/^SigCgt/ { print $2 }' /proc/$pid/status)
    (( 16#${caught: -2} & 2 )) && break
    sleep 0.1
  done
  sleep 0.5
  kill -INT $pid
  for ((i = 0; i < 50; ++i)); do kill -0 $pid 2>/dev/null || break; sleep 0.1; done
  kill -9 $pid 2>/dev/null && fail "$command: a FIFO without another end ignores SIGINT"
  code=0
  wait $pid || code=$?
  [[ $code == 130 ]] && grep -q 'grainlaw: interrupted' log || fail "$command: interrupted before a FIFO: $code $(cat log)"
done
before=$(find out/runs -name run.json -printf '%p %T@\n' | sort)
sed -i 's/"eps_dev": 100/"eps_dev": 0.01/' spec.json
"$grainlaw" calibrate spec.json -o out >/dev/null 2>log || [[ $? == 2 || $? == 3 ]]  # 64 spheres at one density make no law
[[ $(find out/runs -name run.json -printf '%p %T@\n' | sort | comm -12 - <(echo "$before")) == "$before" ]] || fail "finished runs were repeated"
