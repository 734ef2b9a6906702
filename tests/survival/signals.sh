# SIGINT and SIGTERM, once and twice (hard case R10), amid a preparation and amid a test: exit code 130, a word about it, a
# checkpoint of the last step; the same command goes on to the same bits.
set -euo pipefail
. "$GRAINLAW_SOURCE_DIR/tests/survival/scene.bash"
set -m  # background jobs keep SIGINT
slow_down

interrupted=0
for ((i = 0; i < ${SIGNALS:-8} || interrupted < 3; ++i)); do
  ((i < 100)) || fail "only $interrupted of $i signals came in time"
  signal=$( ((i % 2)) && echo TERM || echo INT)
  "$grainlaw" simulate test.json -o out --threads 1 --checkpoint 1e6 >stdout 2>log &
  pid=$!
  # until the handler of SIGINT is there, or the process gone
  until [[ ! -e /proc/$pid/status ]] || grep -q '^SigCgt:.*[2367abef]$\|^State:.*Z' /proc/$pid/status; do sleep 0.002; done
  sleep "$(awk -v i="$i" -v s="$whole_seconds" 'BEGIN { print s * (0.2 + 0.2 * (i % 4)) }')"
  kill -"$signal" $pid 2>/dev/null || true
  if ((i % 4 == 3)); then kill -"$signal" $pid 2>/dev/null || true; fi
  code=0
  wait $pid || code=$?
  # on its way out, with all results written, the program leaves signals to the system again
  if ((code == 0)) || { [[ $(results out 2>/dev/null) == "$reference" ]] && ! grep -q 'grainlaw: interrupted' log; }; then
    check_finished out "SIG$signal came too late"
    rm -rf out
    continue
  fi
  ((code == 130)) || fail "SIG$signal: exit code $code: $(cat log)"
  interrupted=$((interrupted + 1))
  if ((i % 4 != 3)); then  # the second signal ends at once, without a word
    grep -q 'grainlaw: interrupted' log || fail "SIG$signal: no word of it: $(cat log)"
  fi
  check_unfinished out "SIG$signal" >/dev/null
done
"$grainlaw" simulate test.json -o out --threads 1 --quiet >/dev/null
check_finished out "after $interrupted signals"

# R10 asks for at most 2 s at the paper's size: measured where PAPER_SIZE=yes, never in a plain test. One preparation is
# interrupted again and again, each time farther on.
slowest=0
if [[ ${PAPER_SIZE:-no} == yes ]]; then
  echo '{"particles": 9261, "seed": 1, "initial": {"nu": 0.74}, "segments": [{"mode": "D2", "extent": {"eps_dev": 0.3}}]}' >large.json
  for ((i = 0; i < 10; ++i)); do
    "$grainlaw" simulate large.json -o large --checkpoint 1e6 >stdout 2>log &
    pid=$!
    sleep "$(awk -v i="$i" 'BEGIN { print 2 + 1.3 * i }')"
    before=$(date +%s.%N)
    kill -INT $pid || fail "SIGINT at the paper's size: the run had ended by itself"
    code=0
    wait $pid || code=$?
    slowest=$(awk -v b="$before" -v a="$(date +%s.%N)" -v s="$slowest" 'BEGIN { d = a - b; print (d > s ? d : s) }')
    ((code == 130)) || fail "SIGINT at the paper's size: exit code $code: $(cat log)"
  done
  [[ -n $(find large -name checkpoint) ]] || fail "no checkpoint at the paper's size"
  echo "signals.slowest_exit_seconds $slowest"
fi
printf '%s %s\n' signals.interrupted "$interrupted" signals.runs_finished "$sound"
