#!/usr/bin/env bash
# tests/acceptance/calibration.sh [--quick]: how far the calibration can be trusted, one line each:
#   NAME VALUE BOUND ok|short          exit 0 only if none is short
# --quick, all from the shipped data (examples/paper/data): the refit and whether it gives the same digits on one and two
# threads, verdicts on the published numbers. Otherwise also the coverage of the stated errors, and calibrations to wanted ones.
#   verdicts.WHERE.VERDICT             how many of the numbers of a table or figure; their names: build/acceptance/calibration
#   PATH.RUNG.QUANTITY.bias, .rms      the shipped uniaxial runs that no fit saw, mean over seeds
set -euo pipefail

# shellcheck source=tests/acceptance/setup.sh
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" "$@"
out+=/calibration
data=examples/paper/data

# Everything that the fit says, without what names the run (provenance, seconds).
digits() { jq -S 'del(.provenance) | del(.. | .seconds?)' "$1"; }

refit() {
  local threads begin
  for threads in 1 2; do
    rm -rf "$out/refit-$threads"
    begin=$EPOCHREALTIME
    $bin/grainlaw calibrate --dataset "$data/dataset" -o "$out/refit-$threads" --threads "$threads" --quiet >/dev/null
    figure_of_time "refit.threads$threads" "$(awk -v a="$begin" -v b="$EPOCHREALTIME" 'BEGIN { print b - a }')" "<=500"
  done
  figure refit.same_digits_on_threads \
    "$(cmp -s <(digits "$out/refit-1/calibration.json") <(digits "$out/refit-2/calibration.json") && echo 1 || echo 0)" ">=1"
}

# Table or figure of every verdict, its verdict and its name.
verdicts() {
  local calibration=$out/refit-1/calibration.json names=$out/verdicts.txt
  jq -r '
    def figure_of: {C_star: "Fig._6", steady_C_star: "Fig._6", rattler_fraction: "Fig._7", steady_rattler_fraction: "Fig._7",
      P_star: "Fig._9", steady_P_star: "Fig._9", stress_ratio_max: "Fig._15", stress_rate: "Fig._15", fabric_max: "Fig._16",
      fabric_rate: "Fig._16"}[.];
    def table_of: if test("^(stress|fabric)_(ratio_max|max|rate)") then "Table_3" elif test("^overlap") then "Eq._13"
      elif test("^fabric.g3") then "Sec._6.1.2" else "Table_2" end;
    (.verdicts[] | "\(if .nu == null then .quantity | table_of else .quantity | figure_of end) \(.verdict | gsub(" "; "_")) \(.mode) \(.quantity) \(.nu // "") ours \(.ours) ± \(.standard_error) published \(.published) distance \(.distance)"),
    (.claims[] | "\(.where | gsub(" "; "_")) \(.verdict | gsub(" "; "_")) \(.statement) \(.nu // "") ours \(.ours) ± \(.standard_error) published \(.published // "> 0")")
    ' "$calibration" | sort >"$names"
  while read -r number where verdict; do figure "verdicts.$where.$verdict" "$number" stated; done \
    < <(awk '{ print $1, $2 }' "$names" | sort -V | uniq -c)
}

# Largest E_kin/E_pot of the isotropic compression above nu = .68, where the packing is jammed, of one CSV.
energy_ratio() {
  awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
           $column["nu"] >= 0.68 { r = $column["E_kin[J]"] / $column["E_pot[J]"]; sum += log(r); rows++ }
           END { print rows ? exp(sum / rows) : "missing" }' "$1"
}

# Fig. 3: how much smaller the ratio becomes at a tenth of the rate (geometric mean over the rows).
slow_cycle() {
  figure Fig._3.energy_ratio_over_ten_times_slower "$(awk -v a="$(energy_ratio $data/dataset/ISO-loading-s1.csv)" \
    -v b="$(energy_ratio $data/slow-cycle/loading.csv)" 'BEGIN { print a / b }')" stated
}

# Figs. 12 and 14: predictions of runs that no fit saw, and what the paper sees in them.
uniaxial() {
  local path rung quantity bias rms nu
  for path in examples/paper/uniaxial-*.json; do
    path=$(basename "$path" .json)
    $bin/grainlaw predict "$out/refit-1/parameters.json" "examples/paper/$path.json" --against "$data/$path" \
      -o "$out/refit-1/predictions/$path" --quiet >/dev/null
    while read -r rung quantity bias rms; do
      figure "$path.$rung.$quantity.bias" "$bias" stated
      figure "$path.$rung.$quantity.rms" "$rms" stated
    done < <(jq -r '.comparisons[] | select(.seed == null and .initial == "measured") as $c | $c.quantities[]
                    | "\($c.model) \(.quantity) \(.bias) \(.normalised_rms)"' "$out/refit-1/predictions/$path/comparison.json")
    nu=${path#uniaxial-}
    figure "Fig._14.fabric_is_largest_at.$nu" "$(largest_fabric "$data/$path"/*.csv)" stated
  done
  for strain in 0.02 0.075 0.12; do
    figure "Fig._12.range_of_s_over_the_paths.at_$strain" "$(for path in "$data"/uniaxial-*; do stress_ratio "$strain" "$path"/*.csv; done |
      awk 'NR == 1 { low = high = $1 } { if ($1 < low) low = $1; if ($1 > high) high = $1 } END { print high - low }')" stated
  done
}

# Mean s_par over the packings within .01 of a deviatoric strain.
stress_ratio() { # strain csv...
  awk -F, -v e="$1" 'FNR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
    $column["eps_dev"] >= e - 0.01 && $column["eps_dev"] <= e + 0.01 { sum += $column["s_par"]; rows++ }
    END { print sum / rows }' "${@:2}"
}

# Deviatoric strain at which F_par, mean over the packings in bins of .01, is largest.
largest_fabric() { # csv...
  awk -F, 'FNR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
    { bin = int($column["eps_dev"] / 0.01); sum[bin] += $column["F_par"]; rows[bin]++ }
    END { best = -1; for (b in sum) if (sum[b] / rows[b] > best) { best = sum[b] / rows[b]; at = b }
          print 0.01 * at + 0.005 }' "$@"
}

# Uniaxial compression to a wanted error of P*, by the cheapest plan, and what new packings say of it.
wanted_errors() {
  local wanted stated reached chance seconds
  for wanted in 0.05 0.02 0.01; do
    examples/target/run.sh "$wanted" "$out/target-$wanted" --quantity P_star >"$out/target-$wanted.txt"
    read -r stated reached chance seconds < <(awk '$1 == "P_star" { gsub("%", ""); print $3 / 100, $4 / 100, $5 / 100, $6 }' \
      "$out/target-$wanted.txt")
    figure "wanted.$wanted.stated" "${stated:-missing}" "<=$wanted"
    figure "wanted.$wanted.reached" "${reached:-missing}" "<=$wanted"
    figure "wanted.$wanted.reached_by_chance" "${chance:-missing}" stated
    figure_of_time "wanted.$wanted" "${seconds:-missing}" "$(case $wanted in 0.05) echo "<=500" ;; 0.02) echo "<=5000" ;; *) echo stated ;; esac)"
  done
}

# Processor seconds that Debian's LAMMPS would take at the paper's settings (9261 spheres, 138 1/s, step t_c,min/50) for one
# packing and the tests of a plan's last round, over those of the whole plan. Its rate is measured on one core at both ends of the
# densities (bench_engine, the mean of the times); the steps are those of the shipped runs, carried to the smaller step. Left out, in its
# favour: relaxations, rebuilding lists, the fit, and that one packing has no interval at all; three have the widest one.
price_beside_lammps() {
  local rates=$out/lammps.txt particle_steps wanted price
  mkdir -p "$out/../engine"
  taskset -c 0 $bin/bench_engine "$out/../engine" >"$rates" 2>"$rates.err" || tail -3 "$rates.err" >&2
  for wanted in 0.05 0.02 0.01; do
    particle_steps=$(steps_at_paper_settings "$out/target-$wanted/plan.json")
    price=$(awk -v steps="$particle_steps" -v a="$(value_of rate.lammps.N9261.nu0.66 "$rates")" \
      -v b="$(value_of rate.lammps.N9261.nu0.82 "$rates")" \
      -v ours="$(jq '[.rounds[].seconds] | add' "$out/target-$wanted/plan.json")" -v cores="$(nproc)" \
      'BEGIN { print (a > 0 && b > 0 && ours > 0) ? steps / 2e6 * (1 / a + 1 / b) / (ours * cores) : "missing" }')
    figure "wanted.$wanted.lammps_seconds_over_ours.one_packing" "$price" ">=50"
    figure "wanted.$wanted.lammps_seconds_over_ours.three_packings" "$(awk -v p="$price" 'BEGIN { print (p > 0 ? 3 * p : "missing") }')" stated
  done
}

# Of the first packing's preparation and the plan's shear tests, from the shipped runs.
steps_at_paper_settings() { # plan.json
  local dataset=$data/dataset/dataset.json driven
  driven=$(awk -F, 'FNR > 2 { driven += $1 - last } { last = $1 } END { print driven }' "$data"/dataset/ISO-{loading,unloading}-s1.csv)
  jq --argjson driven "$driven" --slurpfile plan "$1" '
    ($plan[0].rounds[-1].settings.densities) as $densities
    | (.spec.time_step_fraction * 50) as $smaller
    | [.tests[] | select(.role == "calibration" and .packing.seed == 1 and .cost.steps > 0)] as $sheared
    | def mean_steps(mode): [$sheared[] | select(.name | startswith(mode)) | .cost.steps] | add / length;
    $smaller * .tests[0].packing.particles
      * ($driven / $sheared[0].cost.time_step + $densities * mean_steps("D2-0") + 3 * mean_steps("D2-ISO"))' "$dataset"
}

if [[ -d $data ]]; then
  refit
  verdicts
  slow_cycle
  uniaxial
  $bin/grainlaw report "$out/refit-1" -o "$out/refit-1/report.html" >/dev/null
else
  figure shipped_data missing stated # examples/paper/run.sh makes them
fi
if [[ $quick == yes ]]; then finish_figures; exit; fi
figures_of_tests $bin/long 'Studies/Coverage.*' F2. F3. F7.
wanted_errors
price_beside_lammps
finish_figures
