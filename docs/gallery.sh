#!/usr/bin/env bash
# docs/gallery.sh [OUT]: the report pages of the quickstart (simulated: a minute) and of the paper (from the shipped data: seconds), with
# what else the program draws, on one page, OUT/index.html (./grainlaw-gallery). Installs what is missing, builds Release. With
# chromium there are pictures of the pages' first screens, at 1280 x 800 and on a phone. Finished simulations in OUT are reused.
set -euo pipefail

docs=$(realpath "$(dirname "${BASH_SOURCE[0]}")")
out=$(realpath -m "${1:-grainlaw-gallery}")
mkdir -p "$out"
"$docs/../examples/quickstart/run.sh" "$out/quickstart" >"$out/quickstart.txt"
"$docs/../examples/paper/refit.sh" "$out/paper" >"$out/paper.txt"
"$docs/images/prediction.sh" "$out/paper/predictions/uniaxial-0.695" "$out/prediction.svg"

# picture NAME WIDTH HEIGHT: the page's first screen as NAME-WIDTH.png.
picture() {
  chromium --headless=new --no-sandbox --disable-gpu --hide-scrollbars --user-data-dir="$out/.browser" \
    --window-size="$2,$3" --screenshot="$out/$1-$2.png" "file://$out/$1/report.html" >/dev/null 2>&1
}

# entry NAME TITLE COMMAND: a heading, what the page says of itself, and its pictures.
entry() {
  local width
  printf '<h2>%s</h2>\n<p><a href="%s/report.html">The page</a>, %d kB, by <code>%s</code>; <a href="%s.txt">what it prints</a>;\n' \
    "$2" "$1" "$(($(stat -c %s "$out/$1/report.html") / 1024))" "$3" "$1"
  printf '<a href="%s/report.html#predictions">predictions</a>, <a href="%s/report.html#packing">force chains</a>.</p>\n<p>\n' "$1" "$1"
  for width in 1280 390; do
    [[ ! -s $out/$1-$width.png ]] ||
      printf '<a href="%s/report.html"><img src="%s-%d.png" width="%d" alt="First screen, %d pixels wide"></a>\n' \
        "$1" "$1" "$width" $((width / 2)) "$width"
  done
  echo '</p>'
}

if command -v chromium >/dev/null; then
  for name in quickstart paper; do
    picture "$name" 1280 800
    picture "$name" 390 844
  done
  rm -rf "$out/.browser"
fi
{
  echo '<!DOCTYPE html>'
  echo '<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
  echo '<title>Gallery – grainlaw</title><style>'
  cat "$docs/site/site.css"
  echo 'body { display: block; padding: 1rem 2rem; } main { max-width: none; } p { max-width: none; } main img { border: 1px solid var(--rule); vertical-align: top; }'
  echo '</style></head><body><main><h1>Gallery</h1>'
  entry quickstart 'Quickstart: five packings of 2000 spheres, simulated here' 'examples/quickstart/run.sh'
  entry paper 'The paper: five packings of 9261 spheres, from the shipped data' 'examples/paper/refit.sh'
  echo '<h2>A prediction beside grains that the fit never saw</h2><p><img src="prediction.svg" width="900" alt="P*, s and F in uniaxial compression"></p>'
  echo '</main></body></html>'
} >"$out/index.html"
echo "$out/index.html"
