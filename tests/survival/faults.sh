# Faults injected into the system calls of the writers (hard cases R6, R8): a kill at, or an error from, every open, write,
# fsync, rename and unlink in turn; FAULTS of them (default 22), spread over the whole run. After each: a documented exit code and a
# message, nothing half under a final name, finished runs kept; then the same command goes on to the same bits.
set -euo pipefail
. "$GRAINLAW_SOURCE_DIR/tests/survival/scene.bash"
if ! command -v strace >/dev/null || ! strace -o /dev/null true 2>/dev/null; then
  echo "strace is not there or may not trace: skipped" >&2
  exit 77
fi
faults=${FAULTS:-22}
declare -A kinds=(
  [write:KILL]="write:signal=KILL" [fsync:KILL]="fsync:signal=KILL" [rename:KILL]="rename:signal=KILL"
  [openat:KILL]="openat:signal=KILL" [unlink:KILL]="unlink:signal=KILL"
  [write:ENOSPC]="write:error=ENOSPC" [write:EIO]="write:error=EIO" [write:EINTR]="write:error=EINTR"
  [fsync:EIO]="fsync:error=EIO" [rename:EIO]="rename:error=EIO" [openat:ENOSPC]="openat:error=ENOSPC")
order=(write:KILL write:ENOSPC fsync:KILL fsync:EIO rename:KILL rename:EIO openat:KILL openat:ENOSPC write:EIO unlink:KILL write:EINTR)

# a checkpoint every few steps, so that the writers are busy
run() { "$grainlaw" simulate test.json -o out --threads 1 --checkpoint 0.005 "$@"; }

# How often each call happens in a whole run, below the output folder and elsewhere.
strace -f -qq -o calls -e trace=write,fsync,rename,openat,unlink "$grainlaw" simulate test.json -o counted --threads 1 \
  --checkpoint 0.005 >/dev/null 2>&1
declare -A count
for call in write fsync rename openat unlink; do
  count[$call]=$(grep -c "[0-9]* $call(" calls || true)
  ((count[$call] > 0)) || fail "no call of $call seen"
done

done_faults=0 round=0 kill_seen=0 error_seen=0
while ((done_faults < faults)); do
  for kind in "${order[@]}"; do
    ((done_faults < faults)) || break
    call=${kind%%:*}
    # golden-ratio steps visit the whole range evenly
    when=$(awk -v n="${count[$call]}" -v r="$round" 'BEGIN { x = (0.5 + r * 0.6180339887) % 1; print 1 + int(0.9 * x * n) }')
    rm -rf out
    code=0
    strace -f -qq -o trace -e trace="$call" -e inject="${kinds[$kind]}:when=$when" \
      "$grainlaw" simulate test.json -o out --threads 1 --checkpoint 0.005 >stdout 2>log || code=$?
    what="$kind at call $when"
    grep -q 'INJECTED\|killed by SIGKILL' trace || continue  # this run made fewer calls
    grep -q 'SanitizerTool: CHECK failed' log && continue    # a write of an instrumented build's own, which it ends by
    done_faults=$((done_faults + 1))
    case $kind in
      *:KILL) if ((code == 137)); then kill_seen=$((kill_seen + 1)); fi ;;
      *:EINTR) ((code == 0)) || fail "$what: not written again: $(cat log)" ;;
      *) if ((code != 0)); then error_seen=$((error_seen + 1)); fi ;;
    esac
    if ((code == 0)); then
      # of no consequence, e.g. a library that was looked for elsewhere
      check_finished out "$what"
      continue
    fi
    case $code in
      137) ;;
      # the fault strikes each thread: that of the message, too
      1|2|127) [[ -s log ]] || grep -q ' write(2, .*INJECTED' trace || fail "$what: exit code $code without a word" ;;
      *) fail "$what: exit code $code: $(cat log)" ;;
    esac
    check_unfinished out "$what" >unfinished
    run --quiet >/dev/null 2>log || fail "$what: does not go on: $(cat log)"
    check_finished out "$what, resumed"
  done
  round=$((round + 1))
done
((kill_seen > 0 && error_seen > 0)) || fail "of $done_faults faults $kill_seen killed and $error_seen failed: nothing was tested"
printf '%s %s\n' faults.injected "$done_faults" faults.sound "$sound" faults.kills "$kill_seen" faults.errors "$error_seen"
