#!/usr/bin/env bash
# tests/acceptance/driving_modes.sh [GRAINLAW [OUT]]: does it matter how a packing is driven, and what does it cost?
# Packings of 1000 spheres, each driven in several ways: spheres or only walls moving with the cell, cosine or constant
# rate, other steps, other rates; and D2 from the loading beside D2 from the unloading branch. The differences of one
# packing's two runs are averaged over the packings, with a 95 % interval by Student's t.
# Lines: NAME VALUE; the same as a table in OUT/table.md. Two runs at a time, 15 minutes on 2 cores; finished runs in
# OUT (build/acceptance/driving_modes) are reused.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
grainlaw=$(realpath "${1:-$root/build/release/bin/grainlaw}")
out=$(realpath -m "${2:-$root/build/acceptance/driving_modes}")
mkdir -p "$out"

seeds=(1 2 3 4 5 6)
densities=(0.70 0.80) # of D2
rate=276              # the quickstart's, twice the paper's [1/s]
step=0.1              # over the shortest collision time

# name, transport, profile, step and rate over those of the base, tests
ways="base homogeneous cosine 1 1 D2,ISO,loading
wall wall cosine 1 1 D2,ISO
constant homogeneous constant 1 1 D2,ISO
half_step homogeneous cosine 0.5 1 D2,ISO
half_rate homogeneous cosine 1 0.5 D2,ISO
twice_step homogeneous cosine 2 1 D2
twice_rate homogeneous cosine 1 2 D2"

# --- Runs ---------------------------------------------------------------------------------------------------------------
packing() { # seed
  mkdir -p "$out/packing-$1"
  jq -n --argjson seed "$1" --argjson rate "$rate" --args '{particles: 1000, seed: $seed, strain_rate: $rate, nu_end: 0.69,
    keep: ([{nu: 0.68, branch: "loading"}] + [$ARGS.positional[] | tonumber | {nu: ., branch: "loading"},
           {nu: ., branch: "unloading"}])}' "${densities[@]}" >"$out/packing-$1.json"
  echo "packing-$1"
}

test_of() { # name seed state segments transport profile step-factor rate-factor
  jq -n --arg state "packing-$2/$3.state" --argjson segments "$4" --arg transport "$5" --arg profile "$6" \
    --argjson step "$step" --argjson a "$7" --argjson rate "$rate" --argjson b "$8" '{state: $state, segments: $segments,
    transport: $transport, driving: $profile, time_step_fraction: ($step * $a), strain_rate: ($rate * $b)}' >"$out/$1-$2.json"
  echo "$1-$2"
}

shear='[{"mode": "D2", "extent": {"eps_dev": 0.26}}]'
compression='[{"mode": "ISO", "extent": {"target_nu": 0.80}}, {"mode": "ISO", "reverse": true, "extent": {"target_nu": 0.70}}]'

tests() {
  local way transport profile a b kinds seed nu
  while read -r way transport profile a b kinds; do
    for seed in "${seeds[@]}"; do
      [[ $kinds != *ISO* ]] || test_of "$way-ISO" "$seed" loading-0.68 "$compression" "$transport" "$profile" "$a" "$b"
      for nu in "${densities[@]}"; do
        test_of "$way-D2-$nu" "$seed" "unloading-$nu" "$shear" "$transport" "$profile" "$a" "$b"
        [[ $kinds != *loading* ]] ||
          test_of "loading-D2-$nu" "$seed" "loading-$nu" "$shear" "$transport" "$profile" "$a" "$b"
      done
    done
  done <<<"$ways"
}

run_all() { # names on standard input
  xargs -P "$(nproc)" -I NAME "$grainlaw" simulate "$out/NAME.json" -o "$out/NAME" --threads 1 --quiet >/dev/null
}
for seed in "${seeds[@]}"; do packing "$seed"; done | run_all
tests >"$out/tests.txt"
run_all <"$out/tests.txt"

# --- What is seen: lines "way test quantity seed value" ---------------------------------------------------------------------
D2_values() { # steady means; P_star against the start of shear; slopes of s_par and of P_star over its start at small strain
  awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) { sub(/\[.*/, "", $i); at[$i] = i } next }
    { e = $at["eps_dev"]; P = $at["P_star"]; s = $at["s_par"]; F = $at["F_par"] }
    NR == 2 { P_0 = P }
    e <= 0.01 { n++; x += e; xx += e * e; y += s; xy += e * s; z += P / P_0; xz += e * P / P_0 }
    e >= 0.15 { m++; mean_P += P; mean_s += s; mean_F += F; mean_C += $at["C_star"] }
    END { print "P_star", mean_P / m; print "s_par", mean_s / m; print "F_par", mean_F / m; print "C_star", mean_C / m
          print "P_rise", mean_P / m / P_0 - 1
          print "stress_slope", (n * xy - x * y) / (n * xx - x * x)
          print "pressure_slope", (n * xz - x * z) / (n * xx - x * x) }' "$1"
}

ISO_values() { # at four points of the loop, between the two rows beside them
  awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) { sub(/\[.*/, "", $i); at[$i] = i } next }
    { nu = $at["nu"]; P = $at["P_star"]; C = $at["C_star"]; branch = $at["segment"] == 0 ? "loading" : "unloading" }
    NR > 2 { for (k = 1; k <= 2; k++) { target = k == 1 ? 0.72 : 0.77
        if ((nu - target) * (nu_before - target) <= 0 && nu != nu_before) {
          w = (target - nu_before) / (nu - nu_before); label = sprintf("%s_%.2f", branch, target)
          print "P_star." label, P_before + w * (P - P_before); print "C_star." label, C_before + w * (C - C_before) } } }
    { nu_before = nu; P_before = P; C_before = C }' "$1"
}

while read -r name; do
  seed=${name##*-} run=${name%-*}
  way=${run%%-*} test=${run#*-}
  if [[ $test == ISO ]]; then ISO_values "$out/$name/series.csv"; else D2_values "$out/$name/series.csv"; fi |
    while read -r quantity value; do echo "$way $test $quantity $seed $value"; done
  jq -r --arg run "$way $test" --arg seed "$seed" \
    '.cost | "\($run) steps \($seed) \(.steps)", "\($run) seconds \($seed) \(.seconds)"' "$out/$name/simulation.json"
done <"$out/tests.txt" | sort -u >"$out/values.txt"

# --- Differences from the base, paired by packing ---------------------------------------------------------------------------
awk '
  BEGIN { split("12.706 4.303 3.182 2.776 2.571 2.447 2.365 2.306 2.262", t, " ") } # 97.5 % of Student t, 1 to 9 degrees
  { value[$1, $2, $3, $4] = $5; seed[$4] = 1; if (!seen[$1 " " $2 " " $3]++) order[++rows] = $1 " " $2 " " $3 }
  END {
    for (r = 1; r <= rows; r++) {
      split(order[r], key, " "); way = key[1]; name = way "." key[2] "." key[3]; n = sum = base = squares = 0
      for (s in seed) if ((way, key[2], key[3], s) in value && ("base", key[2], key[3], s) in value) {
        difference[++n] = value[way, key[2], key[3], s] - value["base", key[2], key[3], s]
        sum += difference[n]; base += value["base", key[2], key[3], s] }
      if (way == "base" || key[3] == "seconds" || key[3] == "steps") { print name, (sum + base) / n; continue }
      for (i = 1; i <= n; i++) squares += (difference[i] - sum / n) ^ 2
      half = t[n - 1] * sqrt(squares / (n - 1) / n)
      print name ".difference", sum / n; print name ".half_interval", half
      print name ".differs", (sum / n > half || sum / n < -half)
    }
  }' "$out/values.txt" | tee "$out/figures.txt"

# The same by way and test: means of the base, then differences and their half intervals, in per cent of the base's mean or
# (P_rise, pressure_slope, whose means are small) as they are. Bold: differs.
table() { # test-prefix quantity...
  awk -v prefix="$1" -v quantities="${*:2}" '
    { value[$1] = $2; split($1, key, "."); way = key[1]; test = $1; sub(/^[^.]*\./, "", test)
      if (match(test, /^D2-0\.[0-9]+/) || match(test, /^ISO/)) test = substr(test, 1, RLENGTH); else next
      if (index(test, prefix) == 1 && !seen[way " " test]++) order[++rows] = way " " test }
    function cell(way, test, quantity,   name, base, difference, half, text) {
      base = value["base." test "." quantity]; name = way "." test "." quantity
      if (way == "base") return sprintf("%.4g", base)
      difference = value[name ".difference"]; half = value[name ".half_interval"]
      text = sprintf("%+.1f ± %.1f %%", 100 * difference / base, 100 * half / base)
      if (quantity ~ /^(P_rise|pressure_slope)$/) text = sprintf("%+.3f ± %.3f", difference, half)
      return value[name ".differs"] ? "**" text "**" : text }
    END { n = split(quantities, quantity, " "); line = "| way | test |"; rule = "|---|---|"
      for (q = 1; q <= n; q++) { line = line " " quantity[q] " |"; rule = rule "---|" }
      print line; print rule
      for (r = 1; r <= rows; r++) { split(order[r], key, " "); line = "| " key[1] " | " key[2] " |"
        for (q = 1; q <= n; q++) line = line " " cell(key[1], key[2], quantity[q]) " |"
        print line } }' "$out/figures.txt"
  echo
}
{
  table D2 P_star s_par F_par C_star P_rise stress_slope pressure_slope
  table ISO {P,C}_star.{,un}loading_{0.72,0.77}
} >"$out/table.md"
