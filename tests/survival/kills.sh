# SIGKILL at random moments (hard case R6), KILLS times (default 12): each time the same command goes on, loses at most one
# interval, never a finished run, and ends with the bits of the uninterrupted run. The moments and the interval are fractions
# of the time that the run takes here, so that a fast machine is struck as often as a slow one.
set -euo pipefail
. "$GRAINLAW_SOURCE_DIR/tests/survival/scene.bash"
kills=${KILLS:-12}
slow_down

RANDOM=7
interval=$(awk -v s="$whole_seconds" 'BEGIN { print s / 40 }')
starts=0 killed=0 finished_runs=0 resumed=0 last_step=0
while ((killed < kills || resumed == 0)); do
  starts=$((starts + 1))
  ((starts <= 20 * kills + 100)) || fail "only $killed of $starts kills came in time, $resumed runs went on from a checkpoint"
  delay=$(awk -v r=$RANDOM -v s="$whole_seconds" 'BEGIN { print s * (0.1 + r / 32768) }')
  code=0
  timeout --signal KILL "$delay" "$grainlaw" simulate test.json -o out --threads 1 --checkpoint "$interval" \
    >/dev/null 2>log || code=$?
  step=$(sed -n 's/.*goes on from the checkpoint at step \([0-9]*\).*/\1/p' log | tail -1)
  if [[ -n $step ]]; then
    resumed=$((resumed + 1))
  fi
  if ((code == 137)); then
    killed=$((killed + 1))
    now=$(check_unfinished out "kill $killed") || exit 1
    ((now >= finished_runs)) || fail "kill $killed: a finished run was lost"
    # within one run the restart point never moves back
    if [[ -n $step && $now == "$finished_runs" ]]; then
      ((step >= last_step)) || fail "kill $killed: went on from step $step after $last_step"
      last_step=$step
    fi
    if ((now > finished_runs)); then last_step=0; fi
    finished_runs=$now
  else
    ((code == 0)) || fail "exit code $code without a kill: $(cat log)"
    check_finished out "after $killed kills"
    rm -rf out
    finished_runs=0 last_step=0
  fi
done
simulate out >/dev/null
check_finished out "after the last kill"
printf '%s %s\n' kills.survived "$killed" kills.runs_finished "$sound" kills.starts_from_a_checkpoint "$resumed"
