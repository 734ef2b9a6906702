# The committed examples are valid input, and every key of the quickstart is documented.
set -euo pipefail
grainlaw=$1
fail() { echo "FAIL: $*" >&2; exit 1; }
quickstart=$GRAINLAW_SOURCE_DIR/examples/quickstart
set -m
"$grainlaw" calibrate "$quickstart/spec.json" -o out >/dev/null 2>log &
pid=$!
for ((i = 0; i < 300; ++i)); do [[ -s out/spec.resolved.json ]] && break; sleep 0.1; done
kill -TERM $pid 2>/dev/null || true
wait $pid || [[ $? == 130 ]] || fail "$(cat log)"
[[ -s out/spec.resolved.json ]] || fail "the spec was not accepted: $(cat log)"
