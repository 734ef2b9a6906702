# The pages as a site: complete, without a network, links and anchors lead somewhere, broken ones are found, and the search
# finds from disk, in a browser. Skipped without python3-markdown-it; the browser's part without chromium.
set -euo pipefail
source=$GRAINLAW_SOURCE_DIR
fail() { echo "FAIL: $*" >&2; exit 1; }
/usr/bin/python3 -c 'import markdown_it' 2>/dev/null || exit 77

"$source/docs/site/build.py" site >out || fail "$(cat out)"
grep -Eq '^[0-9]+ pages, [0-9]+ links' out || fail "$(cat out)"
for page in index tutorial own-material commands formats conventions theory/law validation decisions/0001-license; do
  [[ -s site/$page.html ]] || fail "no $page.html"
done
! grep -rhoE '(src|href)="(https?:)?//[^"]*\.(js|css|svg|png|woff2?)"' site || fail "something is loaded from elsewhere"

# Each link of the HTML, not only of the Markdown, is a file, and each anchor an id in it.
/usr/bin/python3 - site <<'PYTHON' || fail "a link leads nowhere"
import pathlib, re, sys
text = {p: p.read_text() for p in pathlib.Path(sys.argv[1]).rglob("*.html")}
ids = {p.resolve(): set(re.findall(r'id="([^"]*)"', t)) for p, t in text.items()}
links = sorted({(p, l) for p, t in text.items() for l in re.findall(r'(?:href|src)="([^"]*)"', t) if not re.match("[a-z]+:", l)})
for page, link in links:
    target, _, anchor = link.partition("#")
    file = (page.parent / target if target else page).resolve()
    if not file.is_file():
        sys.exit(f"{page}: {link} leads to no file")
    if anchor and anchor not in ids[file]:
        sys.exit(f"{page}: {link} has no anchor")
if len(links) <= 200:
    sys.exit(f"only {len(links)} links were looked at")
PYTHON

# sow FILE TEXT EXPECTED: a fault in a copy is named.
sow() {
  rm -rf copy && cp -r "$source/docs" copy
  printf '%s\n' "$2" >>"copy/$1"
  ! copy/site/build.py faulty 2>err || fail "not noticed: $2"
  grep -qF -- "$3" err || fail "expected '$3', got: $(cat err)"
}
sow commands.md '[x](nowhere.md)' 'docs/commands.md: (nowhere.md) leads to no file'
sow commands.md '[x](formats.md#nothing-here)' 'docs/commands.md: (formats.md#nothing-here) has an anchor that is not there'
sow theory/law.md '![x](../images/none.svg)' 'docs/theory/law.md: (../images/none.svg) leads to no file'
sow unlisted.md '# A page' 'docs/unlisted.md: docs/index.md leaves it out'

command -v chromium >/dev/null || { echo "no chromium: the search was not tried"; exit 0; }
# found WORDS: the addresses that the search gives, from disk.
found() {
  timeout 60 chromium --headless=new --no-sandbox --disable-gpu --user-data-dir="$PWD/browser" --virtual-time-budget=5000 \
    --dump-dom "file://$PWD/site/theory/law.html?q=$1" 2>/dev/null | tr '\n' ' ' |
    grep -oE '<section id="found".*</section>' | grep -oE 'href="[^"]*"' || true
}
found contact_viscosity >hits
grep -q 'own-material.html#' hits && grep -q 'formats.html#spec' hits || fail "contact_viscosity is not found: $(cat hits)"
[[ -z $(found zzyzx) ]] || fail "what is nowhere was found"
