#!/usr/bin/env bash
# tests/page/run.sh MODULES [PAGE [OUT]]: the script of the page by itself, and with PAGE that page in headless Chromium; its
# screenshots and print.pdf go to OUT. npm's packages are kept in MODULES. Exit code 77 when something needed is missing.
set -euo pipefail
here=$(realpath "$(dirname "${BASH_SOURCE[0]}")")
modules=$(realpath -m "${1:?MODULES}")

skip() { echo "tests/page/run.sh: skipped: $*" >&2; exit 77; }
command -v node >/dev/null || skip "no node (apt-get install nodejs)"
node --test "$here/script_test.mjs"
[[ $# -ge 2 ]] || exit 0
for program in chromium npm; do command -v $program >/dev/null || skip "no $program (apt-get install $program)"; done
mkdir -p "$modules"
if ! cmp -s "$here/package-lock.json" "$modules/package-lock.json" || [[ ! -d $modules/node_modules/puppeteer-core ]]; then
  cp "$here"/package.json "$modules/"
  cp "$here"/package-lock.json "$modules/"
  (cd "$modules" && npm ci --silent --no-audit --no-fund) >&2 || skip "npm ci failed; is there a network?"
fi
GRAINLAW_PAGE=$(realpath "$2") GRAINLAW_PAGE_OUT=${3:+$(realpath -m "$3")} GRAINLAW_PAGE_MODULES=$modules \
  node --test --test-reporter tap "$here/browser_test.mjs"
