#!/usr/bin/env bash
# The page of the shipped data in a browser, and its numbers: tests/page. Skipped without node, npm and chromium.
set -euo pipefail
grainlaw=$1
source=$GRAINLAW_SOURCE_DIR/examples/paper
fail() { echo "FAIL: $*" >&2; exit 1; }

"$grainlaw" calibrate --dataset "$source/data/dataset" -o out --quiet >/dev/null
name=uniaxial-0.671
"$grainlaw" predict out/parameters.json "$source/$name.json" --against "$source/data/$name" -o "out/predictions/$name" --quiet >/dev/null
"$grainlaw" report out -o page.html >/dev/null

# --json has what stands on the page; the page itself is not needed for it
"$grainlaw" report out --json >page.json || fail "report --json"
jq -e '[.sections[].contents[] | select(.figure).panels[].series[].y | length] | add > 10000' page.json >/dev/null || fail "numbers of figures"
jq -e '[.sections[].contents[] | select(.table).rows[][] | select(.value)] | length > 1000' page.json >/dev/null || fail "numbers of tables"
for id in $(jq -r '.sections[].contents[] | select(.figure) | .figure' page.json); do
  grep -q "<figure id=\"$id\">" page.html || fail "figure $id"
done

"$GRAINLAW_SOURCE_DIR/tests/page/run.sh" "$GRAINLAW_BUILD_DIR/page" page.html
