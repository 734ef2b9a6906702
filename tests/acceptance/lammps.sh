#!/usr/bin/env bash
# tests/acceptance/lammps.sh [--quick]: LAMMPS behind the element tests, beside our engine, one line each:
#   NAME VALUE BOUND ok|short          exit 0 only if none is short
# Stress of one packing at its first row; D2 of four packings over the scatter of packings; ns per step and particle over
# ranks and sizes; what friction does. --quick: sizes up to 10^4, no friction. Times want a machine that does nothing else.
# Sourced by another script that has sourced setup.sh it only defines lammps_figures.

lammps_spec='{"particles": 500, "seeds": [1, 2, 3, 4], "strain_rate": 552, "time_step_fraction": 0.2, "rows": 40, "driving": "constant",
  "nu_end": 0.67, "densities": [0.72],
  "tests": [{"mode": "ISO", "role": "calibration"}, {"mode": "D2", "strain": 0.26, "role": "calibration"}]}'

# largest_distance QUANTITY FOLDER-OF-OURS FOLDER-OF-THEIRS [TEST]: rms over the rows of |mean of theirs - mean of ours| in units of
# the standard error of that difference, from the scatter over packings of both.
lammps_distance() {
  /usr/bin/python3 - "$@" <<'PY'
import glob, sys
import numpy as np
quantity, ours, theirs = sys.argv[1:4]
def table(folder):
    files = sorted(glob.glob(f"{folder}/D2-0.72-s*.csv"))
    return np.array([[float(row.split(",")[column]) for row in lines[1:]] for lines in (open(f).read().splitlines() for f in files)
                     for column in [[t.split("[")[0] for t in lines[0].split(",")].index(quantity)]])
a, b = table(ours), table(theirs)
error = np.sqrt(a.var(axis=0, ddof=1) / len(a) + b.var(axis=0, ddof=1) / len(b))
print(f"{np.sqrt(np.mean(((a.mean(axis=0) - b.mean(axis=0)) / error) ** 2)):.3g}")
PY
}

lammps_curves() {
  local engine seed state quantity
  mkdir -p "$lammps_out/same"
  echo "$lammps_spec" >"$lammps_out/grainlaw.json"
  jq '.engine = "lammps"' "$lammps_out/grainlaw.json" >"$lammps_out/lammps.json"
  for engine in grainlaw lammps; do  # too few tests for a law: what is asked for is the data set
    "$bin/grainlaw" calibrate "$lammps_out/$engine.json" -o "$lammps_out/$engine" --quiet >/dev/null 2>&1 || true
  done
  for seed in 1 2 3 4; do  # the same packings: those of our engine in LAMMPS
    state=$(jq -r --argjson seed $seed 'select(.kind == "preparation" and .packing.seed == $seed) | .key' "$lammps_out"/grainlaw/runs/*/run.json)
    jq --arg state "$lammps_out/grainlaw/runs/$state/unloading-0.72.state" '{engine: "lammps", state: $state, strain_rate, rows, driving,
      time_step_fraction, segments: [{mode: "D2", extent: {eps_dev: 0.26}}]}' "$lammps_out/grainlaw.json" >"$lammps_out/same/$seed.json"
    "$bin/grainlaw" simulate "$lammps_out/same/$seed.json" -o "$lammps_out/same/$seed" --quiet >/dev/null
    cp "$lammps_out/same/$seed/series.csv" "$lammps_out/same/D2-0.72-s$seed.csv"
  done
  figure lammps.first_row.stress "$(awk -F, 'FNR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /^stress_[xyz][xyz]\[/) c[i] }
    FNR == 2 { for (i in c) if (NR == 2) a[i] = $i; else { d += ($i - a[i])^2; n += a[i]^2 } } END { print (n > 0 ? sqrt(d / n) : "missing") }' \
    <(lammps_double 1) "$lammps_out/same/D2-0.72-s1.csv")" "<=1e-12"
  for quantity in P_star s_par F_par C_star; do
    figure "lammps.same_packings.$quantity" "$(lammps_distance $quantity "$lammps_out/grainlaw/dataset" "$lammps_out/same" || echo missing)" "<=2"
    figure "lammps.own_packings.$quantity" "$(lammps_distance $quantity "$lammps_out/grainlaw/dataset" "$lammps_out/lammps/dataset" || echo missing)" "<=2"
  done
}

# Runs of one path by both engines on the page of a law: series of both in one figure.
lammps_page() {
  local engine law=$lammps_out/law
  "$bin/grainlaw" calibrate --dataset examples/starters/dataset -o "$law" --quiet >/dev/null || (($? == 3))
  echo '{"initial": {"nu": 0.72}, "seeds": [11, 12], "segments": [{"mode": "D2", "extent": {"eps_dev": 0.1}}]}' >"$lammps_out/path.json"
  for engine in grainlaw lammps; do
    "$bin/grainlaw" predict "$law/parameters.json" "$lammps_out/path.json" --dem --model reduced --spec "$lammps_out/$engine.json" --store "$lammps_out/$engine" \
      -o "$law/predictions/d2-$engine" --quiet >/dev/null
  done
  "$bin/grainlaw" report "$law" -o "$law/report.html" --quiet >/dev/null
  for engine in grainlaw lammps; do
    figure "lammps.page.figures_with_runs_by.$engine" "$(grep -o "DEM by $engine, 2 runs" "$law/report.html" | wc -l)" ">=2"
  done
}

# First rows of packing SEED by our engine in double precision (mixed rounds positions to 32 bits), of a cell that begins at rest.
lammps_double() {
  jq 'del(.engine) | .precision = "double" | .driving = "cosine" | .segments[0].extent.eps_dev = 0.001' "$lammps_out/same/$1.json" >"$lammps_out/same/$1-double.json"
  "$bin/grainlaw" simulate "$lammps_out/same/$1-double.json" -o "$lammps_out/same/$1-double" --quiet >/dev/null
  cat "$lammps_out/same/$1-double/series.csv"
}

# lammps_packing PARTICLES TILES: a packing at 0.72 beside itself so many times along each axis, as a table of spheres.
lammps_packing() {
  local folder=$lammps_out/packing-$1
  jq -n --argjson N "$1" '{particles: $N, strain_rate: 1104, time_step_fraction: 0.2, rows: 5, initial: {nu: 0.72}, segments: [{mode: "D2", extent: {eps_dev: 0.1}}]}' >"$folder.json"
  "$bin/grainlaw" simulate "$folder.json" -o "$folder" --quiet >/dev/null
  /usr/bin/python3 - "$folder" "$2" "$lammps_out/spheres-$1-$2" <<'PY'
import itertools, json, sys
folder, tiles, out = sys.argv[1], int(sys.argv[2]), sys.argv[3]
cell = json.load(open(f"{folder}/simulation.json"))["cell"]
edges = [cell[a][a] for a in range(3)]
header, *rows = [line.split(",") for line in open(f"{folder}/end.csv").read().splitlines()]
place = [i for i, title in enumerate(header) if title.split("[")[0] in "xyz"]
name = header.index("id")
with open(f"{out}.csv", "w") as file:
    file.write(",".join(header) + "\n")
    for t, tile in enumerate(itertools.product(range(tiles), repeat=3)):
        for n, row in enumerate(rows):
            row = list(row)
            for a in range(3):
                row[place[a]] = repr(float(row[place[a]]) + tile[a] * edges[a])
            row[name] = str(t * len(rows) + n)
            file.write(",".join(row) + "\n")
json.dump([[tiles * x for x in row] for row in cell], open(f"{out}.cell.json", "w"))
PY
}

# lammps_seconds ENGINE LAUNCHER PARTICLES TILES STEPS: wall time of a run of so many steps, and its steps.
lammps_seconds() {
  local spheres=$lammps_out/spheres-$3-$4 folder
  folder=$(mktemp -d -p "$lammps_out")
  # D2 at a constant rate of 276 1/s; a step takes 1.4e-7 s or so at a fifth of the shortest collision
  jq -n --arg engine "$1" --arg spheres "$spheres.csv" --slurpfile cell "$spheres.cell.json" --argjson steps "$5" '{engine: $engine, spheres: $spheres,
    cell: $cell[0], strain_rate: 276, rows: 2, driving: "constant", segments: [{mode: "D2", extent: {eps_dev: (1.6e-5 * $steps)}}]}' >"$folder/test.json"
  "$bin/grainlaw" simulate "$folder/test.json" -o "$folder/out" --threads 1 --launcher "$2" --quiet >/dev/null
  jq -r '"\(.cost.seconds) \(.cost.steps)"' "$folder/out/simulation.json"
  rm -rf "$folder"
}

# lammps_time ENGINE LAUNCHER PARTICLES TILES STEPS: ns per step and particle, from runs of so many and of three times as many steps.
lammps_time() {
  local short long
  short=$(lammps_seconds "$1" "$2" "$3" "$4" "$5")
  long=$(lammps_seconds "$1" "$2" "$3" "$4" $((3 * $5)))
  echo "$short $long" | awk -v N=$(($3 * $4 * $4 * $4)) '{ printf "%.4g", ($3 - $1) / ($4 - $2) / N * 1e9 }'
}

lammps_times() {
  local particles tiles steps N
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
  while read -r particles tiles steps; do
    N=$((particles * tiles * tiles * tiles))
    lammps_packing "$particles" "$tiles"
    figure "lammps.time.N$N.ours" "$(lammps_time grainlaw "" "$particles" "$tiles" $((10 * steps)))" stated
    figure "lammps.time.N$N.ranks1" "$(lammps_time lammps "" "$particles" "$tiles" "$steps")" stated
    figure "lammps.time.N$N.ranks2" "$(lammps_time lammps "mpirun --oversubscribe -n 2" "$particles" "$tiles" "$steps")" stated
    rm -f "$lammps_out/spheres-$particles-$tiles".*
  done < <(echo "1000 1 2000"; echo "1250 2 200"; [[ $quick == yes ]] || { echo "800 5 20"; })
  [[ $quick == yes ]] || lammps_million
}

# Of a million spheres the text of LAMMPS's rows hides the steps: both engines in memory instead, a hundred steps of a warm packing.
lammps_million() {
  local cores log engine nu
  for cores in 1 2; do
    log=$lammps_out/million-$cores.txt
    "$bin/bench_engine" --cores "$cores" --tiles 5 --steps 100 "$lammps_out" >"$log" 2>"$log.err" || tail -3 "$log.err" >&2
    for engine in lammps mixed; do
      for nu in 0.66 0.82; do
        figure "lammps.time.N1157625.$engine.nu$nu.cores$cores" "$(awk -v rate="$(value_of "rate.$engine.N1157625.nu$nu" "$log")" \
          'BEGIN { print (rate > 0 ? sprintf("%.4g", 1000 / rate) : "missing") }')" stated
      done
    done
  done
}

# What friction does, from a small study: where the packing jams, and the stress ratio that it bears.
lammps_friction() {
  local mu
  GRAINLAW=$bin/grainlaw examples/friction/run.sh "$lammps_out/friction" --small >"$lammps_out/friction.md" 2>"$lammps_out/friction.log" || true
  for mu in 0 0.01 0.1 0.5; do
    figure "lammps.friction.jamming.mu$mu" "$(jq -r '.parameters["pressure.nu_c"].value // "missing"' "$lammps_out/friction/mu$mu/parameters.json")" stated
    figure "lammps.friction.largest_s.mu$mu" "$(for file in "$lammps_out/friction/mu$mu"/dataset/D2-0.7[0-9]-s*.csv; do
      awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == "s_par") c = i; next } $c > most { most = $c } END { print most }' "$file"; done |
      awk '{ sum += $1 } END { print (NR > 0 ? sum / NR : "missing") }')" stated
  done
  figure lammps.friction.jamming_falls "$(jq -s '[.[].parameters["pressure.nu_c"].value] | (.[0] - .[2]) * 1000 | round / 1000' \
    "$lammps_out"/friction/mu{0,0.01,0.1}/parameters.json)" ">=0.01"
  figure lammps.friction.table_rows "$(grep -c '^| [^-]' "$lammps_out/friction.md")" ">=40"
}

lammps_figures() {
  lammps_out=$out/lammps
  rm -rf "$lammps_out"
  mkdir -p "$lammps_out"
  lammps_curves
  lammps_page
  lammps_times
  [[ $quick == yes ]] || lammps_friction
}

if [[ ${BASH_SOURCE[0]} == "$0" ]]; then
  set -euo pipefail
  # shellcheck source=tests/acceptance/setup.sh
  . "$(dirname "${BASH_SOURCE[0]}")/setup.sh" "$@"
  lammps_figures
  finish_figures
fi
