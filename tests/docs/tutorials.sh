# Runs the tutorials, and the README's own prediction, as a reader would: every block of ```sh in order, in one folder.
#   ```text after a block                 its lines are in the block's output, digits and spacing aside
#   <!-- check: COMMAND -->               succeeds
#   <!-- not run: REASON -->              the next block is left out
# Prints a transcript. PAGES=FILE... in the environment runs others, e.g. of a copy in which an output was changed.
set -euo pipefail
grainlaw=$1
source=$GRAINLAW_SOURCE_DIR

# A clone in which the program was built.
mkdir -p build/release/bin
ln -s "$grainlaw" build/release/bin/grainlaw
ln -s "$source/examples" examples
export PATH=$PWD/build/release/bin:$PATH

# pieces PAGE: writes its blocks and checks to piece-001.sh, piece-002.text, piece-003.check ... with the line in piece-NNN.line.
pieces() {
  rm -f piece-*
  awk 'function open(kind) { file = sprintf("piece-%03d", ++n); print NR > (file ".line"); close(file ".line")
                             file = file "." kind; printf "" > file }
    fenced && /^```$/ { fenced = 0; close(file); next }
    fenced { if (file) print > file; next }
    /^<!-- not run: .* -->$/ { skip = 1; next }
    /^<!-- check: / { open("check"); checking = 1; sub(/^<!-- check: /, "") }
    checking { if (sub(/ *-->$/, "")) checking = 0; print > file; if (!checking) close(file); next }
    /^```/ {
      fenced = 1; kind = substr($0, 4); file = ""
      if ((kind == "sh" && !skip) || kind == "text") open(kind)
      skip = 0
    }' "$1"
}

masked() { sed -E 's/[-−+]?[0-9]+(\.[0-9]+)?/#/g; s/[[:space:]]+/ /g; s/^ | $//g'; }

# run PAGE: fails with page, line and reason.
run() {
  local page=$1 piece line text blocks=0 checks=0 begin=$SECONDS
  fail() { echo "FAIL: $page:$line: $*" >&2; exit 1; }
  pieces "$page"
  for piece in piece-*.{sh,text,check}; do [[ ! -e $piece ]] || echo "$piece"; done | sort >order
  while IFS= read -r piece <&3; do
    line=$(<"${piece%.*}.line")
    case $piece in
      *.sh)
        sed 's/^/$ /' "$piece"
        bash -euo pipefail "$piece" >output 2>&1 || fail "exit code $?: $(tail -5 output)"
        cat output
        masked <output >masked
        blocks=$((blocks + 1))
        ;;
      *.text)
        while IFS= read -r text; do
          grep -qxF -- "$(masked <<<"$text")" masked || fail "not in the output: $text"
        done <"$piece"
        ;;
      *.check)
        bash -euo pipefail "$piece" >check 2>&1 || fail "does not hold: $(cat "$piece" check)"
        checks=$((checks + 1))
        ;;
    esac
  done 3<order
  echo "== $(basename "$page"): $blocks blocks, $checks checks, $((SECONDS - begin)) s"
  ((blocks > 0))
}

if [[ -n ${PAGES:-} ]]; then
  for page in $PAGES; do run "$page"; done
  exit
fi
run "$source/docs/tutorial.md"
run "$source/docs/own-material.md"
run "$source/docs/own-data.md"
mkdir grainlaw-quickstart
cp law/parameters.json grainlaw-quickstart/ # what README takes from the quickstart
run "$source/README.md"

# The runner notices words of an output that are others, a check that does not hold, and a command that fails.
for fault in 's/^```text$/&\nno such line/' 's/^<!-- check: /&! /' 's/^echo /false; &/'; do
  sed "$fault" >fault.md <<'PAGE'
```sh
echo "12 apples"
```
```text
13 apples
```
<!-- check: true -->
PAGE
  if (run fault.md) >/dev/null 2>&1; then
    echo "FAIL: not noticed: $fault" >&2
    exit 1
  fi
done
