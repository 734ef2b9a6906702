# A full disk (hard case R8): a tmpfs of a few kB that runs full at every size in turn. Non-zero exit code, a message that
# names file and remedy, no half file under a final name; with space again the same command ends with the same bits.
set -euo pipefail
. "$GRAINLAW_SOURCE_DIR/tests/survival/scene.bash"
mkdir -p disk
if ! mount -t tmpfs -o size=64k grainlaw disk 2>/dev/null; then
  echo "no tmpfs may be mounted here (needs root): skipped" >&2
  exit 77
fi
trap 'umount disk' EXIT

full=0
for kilobytes in 64 48 32 96 128 160; do
  rm -rf disk/out
  mount -o "remount,size=${kilobytes}k" disk
  code=0
  simulate disk/out --checkpoint 0.005 >stdout 2>log || code=$?
  if ((code != 0)); then
    full=$((full + 1))
    ((code == 1)) || fail "$kilobytes kB: exit code $code: $(cat log)"
    grep -q 'No space left on device' log || fail "$kilobytes kB: no word of it: $(cat log)"
    grep -q 'check space and permissions\|cannot be created' log || fail "$kilobytes kB: no remedy: $(cat log)"
    check_unfinished disk/out "$kilobytes kB" >/dev/null
    mount -o remount,size=4m disk
    simulate disk/out >/dev/null 2>log || fail "$kilobytes kB, then space: $(cat log)"
  fi
  check_finished disk/out "$kilobytes kB, then space"
done
((full >= 3)) || fail "only $full of the disks were full"

code=0
"$grainlaw" simulate test.json -o whole --threads 1 --quiet >/dev/full 2>log || code=$?
((code == 1)) || fail "/dev/full as standard output: exit code $code"

# Progress and messages that cannot be written change nothing.
"$grainlaw" simulate test.json -o loud --threads 1 >/dev/null 2>/dev/full || fail "/dev/full as standard error: exit code $?"
check_finished loud "/dev/full as standard error"
code=0
"$grainlaw" simulate none.json -o none 2>/dev/full || code=$?
((code == 2)) || fail "/dev/full as standard error, no input: exit code $code"
printf '%s %s\n' disks.full "$full" disks.sound "$sound"
