# Sourced by page.sh: how a new user gets in. Both tutorials (their transcript: $door/tutorials.txt), the pages of docs/ as a site, what
# README says in a fresh clone up to the curve of one's own path, and the gallery.

door=$out/door
mkdir -p "$door"

seconds_since() { awk -v a="$1" -v b="$EPOCHREALTIME" 'BEGIN { printf "%.1f", b - a }'; }

# NAME: one of tests/docs, its output in $door/NAME.txt.
docs_test() {
  GRAINLAW_SOURCE_DIR=$PWD tests/in_fresh_directory.sh "$PWD/tests/docs/$1.sh" "$PWD/$bin/grainlaw" >"$door/$1.txt" 2>"$door/$1.log" ||
    { tail -3 "$door/$1.log" >&2; false; }
}

tutorials() {
  local begin=$EPOCHREALTIME page
  figure tutorials.hold "$(docs_test tutorials && echo 1 || echo 0)" ">=1"
  figure tutorials.seconds "$(seconds_since "$begin")" "<=120"
  for page in tutorial own-material; do
    figure "tutorials.$page.blocks" "$(sed -nE "s/^== $page.md: ([0-9]+) blocks, .*/\1/p" "$door/tutorials.txt")" stated
    figure "tutorials.$page.checks" "$(sed -nE "s/^== $page.md: .* ([0-9]+) checks, .*/\1/p" "$door/tutorials.txt")" ">=1"
    figure "tutorials.$page.seconds" "$(sed -nE "s/^== $page.md: .* ([0-9]+) s$/\1/p" "$door/tutorials.txt")" "<=600"
  done
}

site() {
  local begin=$EPOCHREALTIME
  docs/site/build.py "$door/site" >"$door/site.txt"
  figure site.seconds "$(seconds_since "$begin")" "<=10"
  figure site.pages "$(sed -nE 's/^([0-9]+) pages.*/\1/p' "$door/site.txt")" stated
  figure site.kB "$(du -sk "$door/site" | cut -f1)" stated
  figure site.links_and_search "$(docs_test site && echo 1 || echo 0)" ">=1"
}

# The README's commands up to the curve of the reader's own path. A command is a line that no other goes on from.
own_path() {
  local clone=$door/clone begin=$EPOCHREALTIME
  rm -rf "$clone"
  git clone --quiet . "$clone"
  awk '/^```sh$/ { inside = 1; ++block; next } /^```$/ { inside = 0 }
       inside && (block == 2 || /quickstart\/run.sh/)' README.md >"$door/commands.sh"
  (cd "$clone" && CCACHE_DISABLE=1 bash -euo pipefail "$door/commands.sh") >"$door/own_path.txt" 2>"$door/own_path.log" ||
    tail -3 "$door/own_path.log" >&2
  figure own_path.commands "$((1 + $(grep -c '^[^ ]' "$door/commands.sh")))" "<=5"
  figure own_path.seconds "$(seconds_since "$begin")" "<=1200"
  figure own_path.rows "$(($(wc -l <"$clone/mine/memory-law.csv") - 1))" ">=100"
}

gallery() {
  local begin=$EPOCHREALTIME name
  docs/gallery.sh "$door/gallery" >"$door/gallery.txt" 2>"$door/gallery.log"
  figure gallery.seconds "$(seconds_since "$begin")" stated
  for name in quickstart paper; do
    figure "gallery.$name.kB" "$(($(stat -c %s "$door/gallery/$name/report.html") / 1024))" stated
  done
  figure gallery.pictures "$(find "$door/gallery" -maxdepth 1 -name '*.png' | wc -l)" ">=4"
}
