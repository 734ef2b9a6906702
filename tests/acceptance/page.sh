#!/usr/bin/env bash
# tests/acceptance/page.sh [--quick]: what the program is in the hands of its users, one line each:
#   NAME VALUE BOUND ok|short          exit 0 only if none is short
# The page in headless Chromium (tests/page): drawn with and without its script, toggles, zoom, keys, links, downloads, axe; its
# size, time and printed pages. Screenshots and prints are left in build/acceptance/page.
# The way in (door.sh): both tutorials, the pages of docs/ as a site, seconds and commands from a clone to one's own path, the gallery.
# --quick: the page of the shipped data, tutorials and site. Otherwise also the page of the quickstart, reused from build/acceptance
# when finished, a fresh clone, built without a compiler cache, the gallery, and the package on a bare system (package.sh).
set -euo pipefail

# shellcheck source=tests/acceptance/setup.sh
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" "$@"
# shellcheck source=tests/acceptance/door.sh
. tests/acceptance/door.sh
./install-packages.sh --full >&2
pages=$out/page
mkdir -p "$pages"

# The page of a calibration's folder: how large and how fast, and what the browser says.
page() { # name folder most-megabytes
  local name=$1 folder=$2 html=$pages/$1.html log=$pages/$1.txt i begin seconds least=1e9
  for i in 1 2 3; do
    begin=$EPOCHREALTIME
    "$bin/grainlaw" report "$folder" -o "$html" --quiet >/dev/null
    seconds=$(awk -v a="$begin" -v b="$EPOCHREALTIME" 'BEGIN { printf "%.2f", b - a }')
    least=$(awk -v a="$least" -v b="$seconds" 'BEGIN { print b < a ? b : a }')
  done
  figure_of_time "page.$name" "$least" "<=17"
  figure "page.$name.megabytes" "$(stat -c %s "$html" | awk '{ printf "%.2f", $1 / 1e6 }')" "<=$3"
  rm -rf "${pages:?}/$name"
  tests/page/run.sh "$PWD/build/release/page" "$html" "$pages/$name" >"$log" || grep '^not ok' "$log" >&2 || true
  figure "page.$name.browser_tests_passed" "$(grep -c '^ok' "$log" || true)" ">=14"
  figure "page.$name.browser_tests_failed" "$(grep -c '^not ok' "$log" || true)" "<=0"
  figure "page.$name.printed_pages" "$(pdfinfo "$pages/$name/print.pdf" 2>/dev/null | awk '/^Pages/ { print $2 }' | grep . || echo missing)" "<=12"
  figure "page.$name.screenshots" "$(find "$pages/$name" -name '*.png' 2>/dev/null | wc -l)" ">=60"
  figure "page.$name.numbers" "$("$bin/grainlaw" report "$folder" --json --quiet | jq '[.. | numbers] | length')" ">=10000"
}

script_size() {
  figure page.script.bytes "$(sed -n '/^<script>/,/<\/script>/p' "$pages/paper.html" | sed 's/^<script>//; s/<\/script>$//' | wc -c)" "<=15360"
}

paper() {
  local folder=$pages/paper-refit
  examples/paper/refit.sh "$folder" >/dev/null
  page paper "$folder" 4
  script_size
}

quickstart() {
  local folder=$out/quickstart
  [[ -s $folder/report.html ]] || examples/quickstart/run.sh "$folder" >&2
  page quickstart "$folder" 1.5
}

package() {
  local log=$pages/package.txt
  tests/acceptance/package.sh >"$log" || true
  grep -q ' ok$' "$log" || figure package missing ">=1"
  while read -r name value bound _; do figure "$name" "$value" "$bound"; done <"$log"
}

paper
tutorials
site
if [[ $quick == no ]]; then
  quickstart
  own_path
  gallery
  package
fi
finish_figures
