#!/usr/bin/env bash
# tests/acceptance/engine.sh [--quick]: the engine's speed beside LAMMPS, its precision and its bits, one line each:
#   NAME VALUE BOUND ok|short          exit 0 only if none is short
# --quick: ratios at both densities and precisions on one core, the precision table, hashes over threads and vector
# instructions, restart points. Otherwise also two cores and a million spheres, both beside LAMMPS, too, and the quickstart's time.
# Run it alone: speeds are measured side by side on a pinned core. The first run prepares packings (two minutes).
set -euo pipefail

# shellcheck source=tests/acceptance/setup.sh
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" "$@"
out+=/engine
mkdir -p "$out"

deviation() { awk -v a="$1" -v b="$2" 'BEGIN { d = b + 0 != 0 ? a / b - 1 : "missing"; print d < 0 ? -d : d }'; }

# Same packing, same steps, same cores; the results must agree before a ratio means anything.
beside_lammps() { # log-of-bench_engine particles infix-of-the-names bound-of-mixed bound-of-double
  local log=$1 infix=$3 nu id precision quantity
  for nu in 0.66 0.82; do
    id=$2.nu$nu
    figure "rate.lammps.$infix$id" "$(value_of "rate.lammps.$id" "$log")" stated
    for precision in mixed double; do
      figure "rate.$precision.$infix$id" "$(value_of "rate.$precision.$id" "$log")" stated
      for quantity in P_star E_pot C_star; do
        figure "$quantity.$precision.$infix$id.off_lammps" "$(deviation "$(value_of "$quantity.$precision.$id" "$log")" \
          "$(value_of "$quantity.lammps.$id" "$log")")" "<=0.02"
      done
    done
    figure "ratio.mixed.$infix$id" "$(value_of "ratio.mixed.$id" "$log")" "$4"
    figure "ratio.double.$infix$id" "$(value_of "ratio.double.$id" "$log")" "$5"
  done
}

beside_lammps_on_one_core() {
  local log=$out/one-core.txt
  taskset -c 0 $bin/bench_engine "$out" >"$log" 2>"$log.err" || tail -3 "$log.err" >&2
  beside_lammps "$log" N9261 "" ">=10" ">=3"
}

other_sizes() {
  local nu precision
  $bin/bench_scaling --threads 2 "$out" >"$out/two-cores.txt"
  taskset -c 0 $bin/bench_scaling --tiles 5 "$out" >"$out/million.txt"
  for nu in 0.66 0.82; do
    for precision in mixed double; do
      figure "two_cores.$precision.nu$nu" "$(value_of "speedup.$precision.nu$nu" "$out/two-cores.txt")" ">=1.8"
      figure "cost_at_a_million.$precision.nu$nu" "$(value_of "cost.$precision.nu$nu" "$out/million.txt")" "<=1.5"
    done
  done
}

# On two cores, and of a million spheres on one (a hundred steps).
beside_lammps_elsewhere() {
  local cores=$out/two-cores-lammps.txt million=$out/million-lammps.txt
  $bin/bench_engine --cores 2 "$out" >"$cores" 2>"$cores.err" || tail -3 "$cores.err" >&2
  taskset -c 0 $bin/bench_engine --tiles 5 --steps 100 "$out" >"$million" 2>"$million.err" || tail -3 "$million.err" >&2
  beside_lammps "$cores" N9261 two_cores. stated stated
  beside_lammps "$million" N1157625 "" stated stated
}

# The force pass beside its floor: 16 pair evaluations take at least 42 cycles by count (docs/performance.md).
floor() {
  local json=$out/kernels.json
  taskset -c 0 $bin/bench_kernels --benchmark_filter='^clock$|^force_and_kick/mixed/AVX3' --benchmark_format=json >"$json"
  figure force_pass.cycles_of_16_pairs "$(jq -r '(.benchmarks[] | select(.name == "clock") | .GHz) as $GHz
    | [.benchmarks[] | select(.name | startswith("force_and_kick/mixed")) | .["ns/sphere"] / .["tiers/sphere"] * $GHz]
    | min // "missing"' "$json")" stated
  figure force_pass.cycles_of_16_pairs.floor 42 stated
}

# Each kernel beside its ceiling: the instructions of one call, counted step by step, at the rate of instructions that wait for nothing.
ceilings() {
  local json=$out/ceilings.json name count peak ns
  $bin/bench_kernels --count >"$out/instructions.txt"
  taskset -c 0 $bin/bench_kernels --benchmark_filter='^peak$|/AVX2$|^averages$' --benchmark_format=json >"$json"
  of() { jq -r --arg name "$1" --arg counter "$2" '[.benchmarks[] | select(.name == $name) | .[$counter]] | first // "missing"' "$json"; }
  peak=$(of peak per_ns)
  figure peak.instructions_per_ns "$peak" stated
  for name in {force_and_kick,kick_and_drift,pick_near,arrange}/{mixed,double}/AVX2 averages; do
    count=$(value_of "$name" "$out/instructions.txt") ns=$(of "$name" ns/sphere)
    figure "ceiling.ns.${name//\//.}" "$(awk -v n="$count" -v peak="$peak" 'BEGIN { print (n > 0 && peak > 0 ? n / peak : "missing") }')" stated
    figure "reached.${name//\//.}" "$(awk -v n="$count" -v peak="$peak" -v ns="$ns" \
      'BEGIN { print (n > 0 && peak > 0 && ns > 0 ? n / peak / ns : "missing") }')" stated
  done
}

quickstart() {
  rm -rf "$out/quickstart"
  examples/quickstart/run.sh "$out/quickstart" >"$out/quickstart.txt" 2>"$out/quickstart.err"
  figure_of_time quickstart "$(sed -n 's/^Whole chain after the build: \([0-9]*\) s.*/\1/p' "$out/quickstart.txt")" "<=1000"
}

beside_lammps_on_one_core
floor
ceilings
figures_of_tests $bin/verification_dem 'Precision*:PortableBits.*:Threads.*' precision.mixed.force precision.mixed.P_star \
  precision.statistics R2.differing_targets R1.differing_hashes
GRAINLAW_TEST_PRECISION=mixed figures_of_tests $bin/verification_dem 'Restart.R5*:Threads.*' R5.differing_restarts R1.differing_hashes
if [[ $quick == no ]]; then
  other_sizes
  beside_lammps_elsewhere
  quickstart
fi
finish_figures
