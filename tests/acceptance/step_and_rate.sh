#!/usr/bin/env bash
# tests/acceptance/step_and_rate.sh GRAINLAW QUICKSTART
# Cost and error of one D2 test at nu = 0.74 from the quickstart's packings, at its own time step and strain rate, at
# twice the step, twice the rate, and at half of both as reference. Lines: NAME VALUE. Errors are differences of
# steady means (eps_dev >= 0.15, mean over packings) from the reference, relative to it; the scatter between packings
# stands beside them, because two runs of one packing soon differ as much as two packings do.
set -euo pipefail

grainlaw=$(realpath "$1")
quickstart=$(realpath "$2")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
spec=$quickstart/spec.resolved.json
step=$(jq .time_step_fraction "$spec")
rate=$(jq .strain_rate "$spec")
times() { awk -v a="$1" -v b="$2" 'BEGIN { print a * b }'; }

# Steady means of P_star, s_par, F_par of a series, by the names in its header.
steady_means() {
  awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) { name = $i; sub(/\[.*/, "", name); column[name] = i } next }
    $column["eps_dev"] >= 0.15 { n++; P += $column["P_star"]; s += $column["s_par"]; F += $column["F_par"] }
    END { print P / n, s / n, F / n }' "$1"
}

run() { # name time_step_fraction strain_rate
  local number=0 state
  : >"$work/$1.means"
  : >"$work/$1.seconds"
  while read -r state; do
    number=$((number + 1))
    jq -n --arg state "$state" --argjson step "$2" --argjson rate "$3" '{state: $state, time_step_fraction: $step,
      strain_rate: $rate, segments: [{mode: "D2", extent: {eps_dev: 0.26}}]}' >"$work/$1-$number.json"
    /usr/bin/time --quiet --format %e --append --output "$work/$1.seconds" \
      "$grainlaw" simulate "$work/$1-$number.json" -o "$work/$1-$number" --threads 1 --quiet >/dev/null
    steady_means "$work/$1-$number/series.csv" >>"$work/$1.means"
  done < <(find "$quickstart/runs" -name 'unloading-0.74.state' | sort)
}

run default "$step" "$rate"
run twice_step "$(times 2 "$step")" "$rate"
run twice_rate "$step" "$(times 2 "$rate")"
run reference "$(times 0.5 "$step")" "$(times 0.5 "$rate")"
for name in default twice_step twice_rate; do
  awk '{ s += $1 } END { print "step_and_rate.'"$name"'.seconds", s / NR }' "$work/$name.seconds"
  for quantity in 1:P_star 2:s_par 3:F_par; do
    awk -v column="${quantity%%:*}" -v label="step_and_rate.$name.${quantity##*:}" '
      FNR == NR { reference += $column; n++; next }
      { sum += $column; squares += $column * $column; m++ }
      END { mean = sum / m; scatter = sqrt((squares / m - mean * mean) * m / (m - 1) / m)
            print label ".error", mean / (reference / n) - 1; print label ".standard_error", scatter / mean }' \
      "$work/reference.means" "$work/$name.means"
  done
done
