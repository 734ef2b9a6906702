#!/usr/bin/env bash
# docs/images/prediction.sh PREDICTION OUT.svg: a prediction of the memory rung and the runs that it was compared with, side by
# side for P*, s_par and F_par. PREDICTION is a folder that `grainlaw predict --against` wrote. The picture of the README:
#   examples/paper/refit.sh OUT && docs/images/prediction.sh OUT/predictions/uniaxial-0.695 docs/images/prediction.svg
set -euo pipefail
(($# == 2)) || { sed -n '2,4s/^# //p' "$0" >&2; exit 2; }

# Normalised errors of the rung as in `grainlaw predict`: mean over the runs.
errors=$(jq -r '[.comparisons[] | select(.model == "memory" and .initial == "law" and .seed != null)] as $runs
  | ["P_star", "s_par", "F_par"][] as $name
  | [$runs[].quantities[] | select(.quantity == $name).normalised_rms] | (add / length)' "$1/comparison.json")
runs=("$1"/dem/*.csv)

# Files in turn: the law, then the runs. Columns are found by their names, units left out.
awk -F, -v errors="$(tr '\n' ' ' <<<"$errors")" -v packings="${#runs[@]}" -v spheres="$(jq '.tests[0].packing.particles' "$1/dem/dataset.json")" '
  FNR == 1 {
    ++file
    for (i = 1; i <= NF; ++i) { sub(/\[.*/, "", $i); column[file, $i] = i }
    next
  }
  {
    n = ++rows[file]
    x[file, n] = $column[file, "nu"]
    for (q = 1; q <= 3; ++q) {
      y[file, q, n] = $column[file, name[q]]
      if (file == 1) { mean[q, n] = $column[1, name[q] "_mean95"]; single[q, n] = $column[1, name[q] "_single95"] }
    }
  }
  BEGIN {
    split("P_star s_par F_par", name, " ")
    split("pressure P*|stress ratio s|fabric anisotropy F", title, "|")
    split(".12 .2 .12", top, " ")
    split(".02 .05 .02", tick, " ")
    split(errors, error, " ")
    from = .69; to = .825; width = 240; height = 190; head = 62
  }
  function left(q) { return 50 + (q - 1) * 300 }
  function px(q, value) { return sprintf("%.1f", left(q) + (value - from) / (to - from) * width) }
  function py(q, value) { return sprintf("%.1f", head + height - (value < 0 ? 0 : value) / top[q] * height) }
  function line(f, q,  d, n) {
    for (n = 1; n <= rows[f]; ++n) d = d (n == 1 ? "M" : "L") px(q, x[f, n]) " " py(q, y[f, q, n])
    return d
  }
  function area(q, half, shade,  d, n) {
    for (n = 1; n <= rows[1]; ++n) d = d (n == 1 ? "M" : "L") px(q, x[1, n]) " " py(q, y[1, q, n] + half[q, n])
    for (n = rows[1]; n >= 1; --n) d = d "L" px(q, x[1, n]) " " py(q, y[1, q, n] - half[q, n])
    printf "<path fill=\"#0072b2\" fill-opacity=\"%s\" d=\"%sZ\"/>\n", shade, d
  }
  END {
    print "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 900 306\" font-family=\"system-ui, DejaVu Sans, sans-serif\" font-size=\"12\">"
    print "<title>Uniaxial compression from a volume fraction of .695: the law and new grains</title>"
    print "<rect width=\"900\" height=\"306\" fill=\"#ffffff\"/>"
    printf "<path stroke=\"#9a9a9a\" d=\"M50 18h26\"/><text x=\"82\" y=\"22\">grains: %d packings of %d spheres that the fit never saw</text>\n", packings, spheres
    print "<path stroke=\"#0072b2\" stroke-width=\"2.2\" d=\"M450 18h26\"/><text x=\"482\" y=\"22\">the law along this path; shaded: 95 % of the mean, of a single run</text>"
    for (q = 1; q <= 3; ++q) {
      printf "<text x=\"%d\" y=\"%d\" font-weight=\"600\">%s</text>", left(q), head - 10, title[q]
      printf "<text x=\"%d\" y=\"%d\" text-anchor=\"end\" fill=\"#5c5c5c\">rms %.1f %%</text>\n", left(q) + width, head - 10, 100 * error[q]
      for (value = 0; value < top[q] * 1.001; value += tick[q])
        printf "<path stroke=\"#ececec\" d=\"M%d %sh%d\"/><text x=\"%d\" y=\"%s\" text-anchor=\"end\">%s</text>\n",
          left(q), py(q, value), width, left(q) - 6, py(q, value) + 4, value
      for (value = .70; value < to; value += .04)
        printf "<text x=\"%s\" y=\"%d\" text-anchor=\"middle\">%.2f</text>\n", px(q, value), head + height + 18, value
      area(q, single, .1)
      area(q, mean, .25)
      for (f = 2; f <= file; ++f) printf "<path fill=\"none\" stroke=\"#9a9a9a\" stroke-width=\".8\" d=\"%s\"/>\n", line(f, q)
      printf "<path fill=\"none\" stroke=\"#0072b2\" stroke-width=\"2.2\" d=\"%s\"/>\n", line(1, q)
      printf "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"none\" stroke=\"#5c5c5c\" stroke-width=\".8\"/>\n", left(q), head, width, height
    }
    printf "<text x=\"450\" y=\"%d\" text-anchor=\"middle\">volume fraction ν, uniaxial compression from .695</text>\n</svg>\n", head + height + 40
  }' "$1/memory-law.csv" "${runs[@]}" >"$2"
