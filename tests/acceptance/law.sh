#!/usr/bin/env bash
# tests/acceptance/law.sh [--quick]: the rungs of the law against DEM runs that the calibration never saw, one line each:
#   NAME VALUE BOUND ok|short          exit 0 only if none is short
# --quick: hard cases of the integration and the study of integrators. Otherwise also the moduli of small-strain probes and
# what examples/law/run.sh makes (both reused from build/acceptance/ when finished). From the measured start, mean over seeds:
#   PATH.RUNG.QUANTITY.bias, .rms      bias, and RMS over the largest |DEM|, per rung
#   PATH.RUNG.QUANTITY.coverage.mean, .single   share of the DEM rows within the band of the mean curve, of a single run
#   PATH.memory.K.s, .F                strain to the sign change in segment K, law over DEM minus 1
#   PATH.memory.K.dip                  least P* of segment K over that at its corner, law minus DEM
#   PATH.RUNG.P_star.largest           of a cyclic path: largest difference of P* in any row, over the largest P* of DEM
#   PATH.memory.*.chance               of a cyclic path's figures, standard error over its packings
#   dilatancy.RUNG.NU                  rise of P* in D2 at constant volume, law (from its own start) minus DEM
# Bounds are the goals of the memory rung; the other rungs are stated.
set -euo pipefail

# shellcheck source=tests/acceptance/setup.sh
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" "$@"
law=$out/law

# The goal for a quantity of a path: of memory alone.
goal() { # path rung quantity kind
  case $1.$2.$3.$4 in
    uniaxial-0.*.memory.s_par.bias | uniaxial-0.*.memory.F_par.bias) echo "<=0.005" ;;
    uniaxial-0.*.memory.P_star.rms) echo "<=0.02" ;;
    cyclic-*.memory.P_star.rms) echo "<=0.03" ;;
    *) echo stated ;;
  esac
}

magnitude() { awk -v x="$1" 'BEGIN { print x < 0 ? -x : x }'; }

held_out() { # folder of a prediction
  local path rung quantity bias rms mean single bound
  path=$(basename "$1")
  while read -r rung quantity bias rms mean single; do
    bound=$(goal "$path" "$rung" "$quantity" bias)
    if [[ $bound == stated ]]; then figure "$path.$rung.$quantity.bias" "$bias" stated
    else figure "$path.$rung.$quantity.|bias|" "$(magnitude "$bias")" "$bound"; fi
    figure "$path.$rung.$quantity.rms" "$rms" "$(goal "$path" "$rung" "$quantity" rms)"
    if [[ $single != null ]]; then
      figure "$path.$rung.$quantity.coverage.mean" "$mean" stated
      figure "$path.$rung.$quantity.coverage.single" "$single" stated
    fi
  done < <(jq -r '.comparisons[] | select(.seed == null and .initial == "measured") as $c | $c.quantities[]
                  | "\($c.model) \(.quantity) \(.bias) \(.normalised_rms) \(.coverage_mean) \(.coverage_single)"' "$1/comparison.json")
}

# Of the means over seeds, row by row; `laws` and `runs`: CSVs of the law and of DEM, by seed.
largest_difference_of_pressure() {
  awk -F, 'FNR == 1 { row = 0; dem = FILENAME ~ /\/dem\//; for (i = 1; i <= NF; i++) column[$i] = i; next }
           { P[dem, row++] += $column["P_star"]; if (row > rows) rows = row }
           END { for (k = 0; k < rows; k++) { d = P[0, k] - P[1, k]; if (d < 0) d = -d; if (d > worst) worst = d; if (P[1, k] > top) top = P[1, k] }
                 print worst / top }' "${laws[@]}" "${runs[@]}"
}

# NAME VALUE of what a cyclic path is judged by.
cyclic_figures() {
  echo "P_star.largest $(largest_difference_of_pressure)"
  paste -d' ' <(awk -f tests/acceptance/reversals.awk "${laws[@]}") <(awk -f tests/acceptance/reversals.awk "${runs[@]}") |
    awk '{ printf "%d.s %.4f\n%d.F %.4f\n%d.dip %.5f\n", $2, $4 / $12 - 1, $2, $6 / $14 - 1, $2, $8 - $16 }'
}

# The same figures' standard errors over the packings of the path: the jackknife, each left out in turn.
chance_of_cyclic_figures() {
  local all_laws=("${laws[@]}") all_runs=("${runs[@]}") laws runs k
  for ((k = 0; k < ${#all_runs[@]}; k++)); do
    laws=("${all_laws[@]:0:k}" "${all_laws[@]:k+1}") runs=("${all_runs[@]:0:k}" "${all_runs[@]:k+1}")
    cyclic_figures
  done | awk '{ n[$1]++; sum[$1] += $2; squares[$1] += $2 * $2 }
    END { for (name in n) { m = sum[name] / n[name]; v = (squares[name] / n[name] - m * m) * (n[name] - 1); print name, sqrt(v > 0 ? v : 0) } }' | sort
}

reversals() { # folder of a prediction
  local path rung name value bound laws runs=("$1"/dem/*.csv)
  path=$(basename "$1")
  for rung in evolution memory; do
    laws=("$1/$rung"-measured-s*.csv)
    while read -r name value; do
      bound=stated
      if [[ $rung == memory ]]; then case $name in *.largest | *.dip) bound="<=0.03" ;; *) bound="<=0.15" ;; esac; fi
      if [[ $bound == stated || $name == *.largest ]]; then figure "$path.$rung.$name" "$value" "$bound"
      else figure "$path.$rung.|$name|" "$(magnitude "$value")" "$bound"; fi
    done < <(cyclic_figures)
    if [[ $rung == evolution ]]; then continue; fi
    while read -r name value; do figure "$path.$rung.$name.chance" "$value" stated; done < <(chance_of_cyclic_figures)
  done
}

# Mean P* over eps_dev >= .15 over that of the first row, minus 1, mean over the CSVs of one density.
rise() { # csv...
  awk -F, 'FNR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
           FNR == 2 { start = $column["P_star"] }
           $column["eps_dev"] >= 0.15 { sum += $column["P_star"] / start; rows++ }
           END { print sum / rows - 1 }' "$@"
}

dilatancy() {
  local nu rung folder dem
  for nu in 0.68 0.70 0.74 0.80; do
    folder=$law/predictions/d2-$nu
    dem=$(rise "$folder"/dem/*.csv)
    figure "dilatancy.DEM.$nu" "$dem" stated
    for rung in evolution memory; do
      figure "dilatancy.$rung.$nu" "$(awk -v a="$(rise "$folder/$rung-law.csv")" -v b="$dem" 'BEGIN { print a - b }')" stated
    done
  done
}

integrators() {
  local study=$out/study_integrator panel least
  taskset -c 0 "$bin/grainlaw" study integrator -o "$study" --quiet >/dev/null
  for panel in smooth reversal near-unjamming; do
    figure_of_time "within_1e-6.adams.$panel" "$(jq -r --arg p "$panel" '.panels[] | select(.path == $p)
      | .["quickest_within_1e-6"][] | select(.integrator == "adams") | .microseconds * 1e-6' "$study/study.json")" \
      "$([[ $panel == smooth ]] && echo "<=5e-4" || echo stated)"
    least=$(jq -r --arg p "$panel" '.panels[] | select(.path == $p) | .["quickest_within_1e-6"]
      | min_by(.microseconds) | "\(.integrator) \(.microseconds * 1e-6)"' "$study/study.json")
    figure_of_time "within_1e-6.${least% *}.$panel" "${least#* }" "$([[ $panel == smooth ]] && echo "<=1.25e-4" || echo stated)"
  done
  figure batch.paths_per_second "$(jq -r '[.batch[].paths_per_second] | max' "$study/study.json")" stated
}

probes() {
  tests/acceptance/probes.sh "$bin/grainlaw" "$out/probes" >"$out/probes.txt"
  while read -r name value; do figure "probes.$name" "$value" stated; done <"$out/probes.txt"
}

hard_cases O
integrators
if [[ $quick == yes ]]; then finish_figures; exit; fi
probes
if [[ ! -s $law/report.html ]]; then examples/law/run.sh "$law" >&2; fi
for folder in "$law"/predictions/*/; do
  held_out "${folder%/}"
  case $folder in *cyclic*) reversals "${folder%/}" ;; esac
done
dilatancy
finish_figures
