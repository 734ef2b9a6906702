#!/usr/bin/env bash
# tests/acceptance/probes.sh [GRAINLAW [OUT]]: elastic moduli along D2, by small-strain probes. Packings of 2000 spheres are
# sheared at four densities and probed on the way. Each figure is a mean over packings of what a packing's probes give, with a
# 95 % interval by Student's t: packings are the unit of chance, probes of one run are not independent.
# Lines: NAME VALUE; the same as tables in OUT/table.md. Two runs at a time, about 10 minutes on 2 cores; finished runs in OUT
# (build/acceptance/probes) are reused.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
grainlaw=$(realpath "${1:-$root/build/release/bin/grainlaw}")
out=$(realpath -m "${2:-$root/build/acceptance/probes}")
mkdir -p "$out"

seeds=(1 2 3 4)
densities=(0.68 0.70 0.74 0.80)
steps='[1e-7, 1e-6, 1e-5, 1e-4]'

# --- Runs ---------------------------------------------------------------------------------------------------------------
packing() { # seed
  jq -n --argjson seed "$1" --args '{particles: 2000, seed: $seed, nu_end: 0.67,
    keep: [$ARGS.positional[] | tonumber | {nu: ., branch: "unloading"}]}' "${densities[@]}" >"$out/packing-$1.json"
  echo "packing-$1"
}

test_of() { # density seed
  jq -n --arg state "packing-$2/unloading-$1.state" --argjson steps "$steps" '{state: $state,
    segments: [{mode: "D2", extent: {eps_dev: 0.2}}], probes: {every: 0.05, step: $steps}}' >"$out/D2-$1-$2.json"
  echo "D2-$1-$2"
}

run_all() { # names on standard input
  xargs -P "$(nproc)" -I NAME "$grainlaw" simulate "$out/NAME.json" -o "$out/NAME" --threads 1 --quiet >/dev/null
}
for seed in "${seeds[@]}"; do packing "$seed"; done | run_all
for seed in "${seeds[@]}"; do for nu in "${densities[@]}"; do test_of "$nu" "$seed"; done; done | tee "$out/tests.txt" | run_all

# --- What a packing shows: lines "density seed quantity value" --------------------------------------------------------------
# Ratios of couplings are slopes through zero over the probes from eps_dev = 0.05 on, e.g. sum A1 F / sum F^2 for A1/F.
while read -r name; do
  seed=${name##*-} nu=${name%-*}
  awk -F, -v run="${nu#D2-} $seed" 'NR == 1 { for (i = 1; i <= NF; i++) { sub(/\[.*/, "", $i); at[$i] = i } next }
    function say(quantity, value) { print run, quantity, value }
    { h = $at["step"]; B = $at["B_star"]; DG = $at["DG_star"]; A1 = $at["A1_star"]; A2 = $at["A2_star"]; P = $at["P_star"]
      s = $at["s_par"]; F = $at["F_par"]; e = $at["eps_dev"]; off = $at["DG_step_star"] / DG - 1
      n[h]++; changed[h] += $at["contacts_closed"] + $at["contacts_opened"]; moved[h] += $at["rearranged"] > 0
      if (!$at["rearranged"]) { kept[h]++; off2[h] += off * off }
      if ($at["contacts_closed"] + $at["contacts_opened"] == 0) { same[h]++; same2[h] += off * off } }
    B == "" || $at["relaxed"] != 1 { say("unusable", 1); next }
    h != 1e-6 { next }
    { d = A1 - 2 / 3 * (A2 - s * P); if (d < 0) d = -d; if (d / B > identity) identity = d / B; places++ }
    e < 0.01 { say("start.B", B); say("start.DG", $at["DG_mean_star"]); say("start.B_over_affine", B / $at["B_affine_star"]) }
    e >= 0.0499 { FF += F * F; BB += B * B * F * F; F1 += A1 * F; F2 += A2 * F; B1 += A1 * B * F; B2 += A2 * B * F }
    e >= 0.0999 { m++; mean_P += P; mean_s += s; mean_F += F; mean_B += B; mean_G += DG; mean_M += $at["DG_mean_star"]
                  mean_1 += A1; mean_2 += A2 }
    END { say("P_star", mean_P / m); say("s_par", mean_s / m); say("F_par", mean_F / m); say("B", mean_B / m)
          say("DG", mean_G / m); say("DG_mean", mean_M / m); say("A1", mean_1 / m); say("A2", mean_2 / m)
          say("A1_over_F", F1 / FF); say("A2_over_F", F2 / FF); say("A1_over_BF", B1 / BB); say("A2_over_BF", B2 / BB)
          say("identity", identity); say("probes", places)
          for (h in n) { say("unchanged_" h, same[h] / n[h]); say("contacts_changed_" h, changed[h] / n[h])
                         say("rearranged_" h, moved[h] / n[h])
                         if (same[h]) say("DG_off_unchanged_" h, sqrt(same2[h] / same[h]))
                         if (kept[h]) say("DG_off_" h, sqrt(off2[h] / kept[h])) } }' "$out/$name/probes.csv"
done <"$out/tests.txt" >"$out/values.txt"

# --- Means over packings ------------------------------------------------------------------------------------------------------
# `all`: of a packing, the mean over densities first.
awk '
  BEGIN { split("12.706 4.303 3.182 2.776 2.571 2.447 2.365 2.306 2.262", t, " ") } # 97.5 % of Student t, 1 to 9 degrees
  function note(key, seed, value) { if (!seen[key]++) order[++rows] = key; all[key, seed] += value; n_of[key, seed]++; seeds[seed] = 1 }
  { note($1 "." $3, $2, $4); note("all." $3, $2, $4) }
  END {
    for (r = 1; r <= rows; r++) {
      key = order[r]; n = sum = squares = 0
      for (s in seeds) if ((key, s) in all) { x[++n] = all[key, s] / n_of[key, s]; sum += x[n] }
      for (i = 1; i <= n; i++) squares += (x[i] - sum / n) ^ 2
      print key, sum / n
      if (n > 1) print key ".half_interval", t[n - 1] * sqrt(squares / (n - 1) / n)
    }
  }' "$out/values.txt" | tee "$out/figures.txt"

table() { # row-keys column-keys, each "key:title", "mean" without intervals; a figure is ROW.COLUMN
  awk -v rows="$1" -v columns="$2" -v mean="${3:-}" '
    { value[$1] = $2 }
    END { nr = split(rows, row, " "); nc = split(columns, column, " "); line = "| |"; rule = "|---|"
      for (c = 1; c <= nc; c++) { split(column[c], part, ":"); key[c] = part[1]; line = line " " part[2] " |"; rule = rule "---|" }
      print line; print rule
      for (r = 1; r <= nr; r++) { line = "| " row[r] " |"
        for (c = 1; c <= nc; c++) { name = row[r] "." key[c]
          line = line " " (!(name in value) ? "" : mean ? sprintf("%.2g", value[name]) : sprintf("%.3g ± %.2g", value[name], value[name ".half_interval"])) " |" }
        print line } }' "$out/figures.txt"
  echo
}
{
  table "${densities[*]}" "start.B:B* start.DG:2G* start.B_over_affine:B/B_affine"
  table "${densities[*]}" "P_star:P* s_par:s F_par:F B:B* DG:2G* DG_mean:2G*,_five_directions A1:A1* A2:A2*"
  table "${densities[*]} all" "A1_over_F:A1*/F A2_over_F:A2*/F A1_over_BF:A1/(BF) A2_over_BF:A2/(BF)"
  for h in 1e-07 1e-06 1e-05 0.0001; do
    echo "h = $h"
    table "${densities[*]}" "unchanged_$h:probes_unchanged contacts_changed_$h:contacts_changed rearranged_$h:probes_rearranged
      DG_off_unchanged_$h:2G_off,_contacts_unchanged DG_off_$h:2G_off,_not_rearranged" mean
  done
} >"$out/table.md"
