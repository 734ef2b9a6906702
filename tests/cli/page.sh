#!/usr/bin/env bash
# A page in a browser, and its numbers: tests/page. Skipped without node, npm and chromium. The page of the starter's data is
# small, so that the browser is quick; the larger ones are with tests/acceptance/page.sh.
set -euo pipefail
grainlaw=$1
fail() { echo "FAIL: $*" >&2; exit 1; }

"$grainlaw" init dataset >/dev/null
jq '.tests[] | select(.name == "D2-0.71-s1").path' dataset/dataset.json >path.json
cp -r dataset runs
jq '.tests |= [.[] | select(.name | startswith("D2-0.71")) | .role = "validation"]' runs/dataset.json >dataset.json
jq '.tests |= map(select(.name | startswith("D2-0.71") | not))' runs/dataset.json >dataset/dataset.json
mv dataset.json runs
"$grainlaw" calibrate --dataset dataset -o out --quiet >/dev/null
for name in compared lone; do
  if [[ $name == compared ]]; then against=(--against runs); else against=(); fi
  "$grainlaw" predict out/parameters.json path.json "${against[@]}" --model reduced -o "out/predictions/$name" --quiet >/dev/null
done
"$grainlaw" report out -o page.html >/dev/null

# --json has what stands on the page; the page itself is not needed for it
"$grainlaw" report out --json >page.json || fail "report --json"
jq -e '[.sections[].contents[] | select(.figure).panels[].series[].y | length] | add > 8000' page.json >/dev/null || fail "numbers of figures"
jq -e '[.sections[].contents[] | select(.table).rows[][] | select(.value)] | length > 1000' page.json >/dev/null || fail "numbers of tables"
for id in $(jq -r '.sections[].contents[] | select(.figure) | .figure' page.json); do
  grep -q "<figure id=\"$id\">" page.html || fail "figure $id"
done

"$GRAINLAW_SOURCE_DIR/tests/page/run.sh" "$GRAINLAW_BUILD_DIR/page" page.html
