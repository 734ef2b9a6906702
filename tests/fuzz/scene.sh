#!/usr/bin/env bash
# scene.sh GRAINLAW FOLDER: what the readers need beside the file that is fuzzed, made by the program itself in a few seconds:
# FOLDER/READER with the file and its companions, FOLDER/seeds/READER with more of its kind. Arrays are cut short: small
# files are read faster, and hold as many kinds of mistakes.
set -euo pipefail
grainlaw=$(realpath "$1") source=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")
mkdir -p "$2" && cd "$2"
slim() { jq -c "walk(if type == \"array\" and length > ${2:-3} then .[:${2:-3}] else . end)" "$1"; }

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cat >"$work/spec.json" <<'JSON'
{"particles": 100, "seeds": [1, 2], "strain_rate": 3000, "rows": 20, "nu_end": 0.67, "densities": [0.70, 0.74, 0.78],
 "tests": [{"mode": "ISO", "role": "calibration"}, {"mode": "D2", "role": "calibration", "density": 0.74},
           {"name": "own", "branch": "loading", "density": [0.74], "role": "rehearsal", "probes": {"every": 0.1},
            "segments": [{"rate_tensor": [[-1, 0, 0], [0, 0.5, 0], [0, 0, 0]], "extent": {"eps_dev": 0.1}}]}]}
JSON
cat >"$work/path.json" <<'JSON'
{"initial": {"nu": 0.74, "branch": "unloading"}, "seeds": [7], "rows": 6, "segments": [{"mode": "D2", "extent": {"eps_dev": 0.05}}]}
JSON
cat >"$work/modes.json" <<'JSON'
{"initial": {"nu": 0.74}, "segments": [{"mode": "D3", "axes": "yzx", "reverse": true, "cycles": {"amplitude": 0.01, "count": 2, "one_sided": true}},
 {"velocity_gradient": [[-1, 1, 0], [0, 0, 0], [0, 0, 0.5]], "extent": {"eps_dev": 0.1}},
 {"mode": "UNI", "free": {"xx": {"quantity": "stress", "rate": 0}}, "extent": {"target_nu": 0.76}}]}
JSON
cat >"$work/test.json" <<'JSON'
{"particles": 12, "seed": 1, "strain_rate": 3000, "rows": 4, "nu_end": 0.67, "initial": {"nu": 0.72}, "segments": [{"mode": "D2", "extent": {"eps_dev": 0.02}}]}
JSON
(
  cd "$work" &&
    "$grainlaw" simulate test.json -o sim &&
    "$grainlaw" simulate <(jq '.particles = 40' test.json) -o framed --frames 1 &&
    "$grainlaw" calibrate --dataset "$source/examples/starters/dataset" -o law &&
    "$grainlaw" predict law/parameters.json path.json --model reduced --dem --spec spec.json -o prediction &&
    "$grainlaw" study fit law --vary packings=2 -o study &&
    "$grainlaw" runs spec.json -o listed --array 2
) >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }

mkdir -p {csv,path,strain,series,dataset,test,spheres,state,checkpoint,store/runs/key,progress,pictures} \
  {parameters,prior,calibration,fitted_paths,prediction,comparison,curve,study} seeds/{json,schema,spec,path,test,spheres,parameters}
runs=("$work"/sim/runs/*/series.csv)
head -7 "$source/examples/starters/dataset/D2-0.68-s1.csv" | tee csv/table.csv >series/series.csv
cp "$work/path.json" path/path.json
cp "$work/modes.json" "$source"/examples/starters/path.json "$source"/examples/law/{d2-d3,cycles/cyclic-0.69-small}.json seeds/path
echo '{"initial": {"nu": 0.72}, "strain_csv": "strain.csv"}' >strain/path.json
cut -d, -f 1-8 "$work/sim/series.csv" >strain/strain.csv
jq -c '.tests |= map(select(.name == "D2-0.68-s1" or .name == "D2-0.68-s2")) | .tests[].role = "validation" | del(.comment, .["$schema"])' \
  "$source/examples/starters/dataset/dataset.json" >dataset/dataset.json
for seed in 1 2; do head -4 "$source/examples/starters/dataset/D2-0.68-s$seed.csv" >"dataset/D2-0.68-s$seed.csv"; done

cp "$work/spec.json" seeds/spec/small.json
for name in starters law law/forms quickstart; do cp "$source/examples/$name/spec.json" "seeds/spec/${name//\//-}.json"; done
cp "$work/test.json" test/test.json
cell=$(jq -c .cell "$work/sim/simulation.json")
for start in '"state": "end.state"' "\"spheres\": \"end.csv\", \"cell\": $cell" '"nu_max": 0.8, "keep": [{"nu": 0.75}]'; do
  segments='"segments": [{"mode": "ISO", "extent": {"target_nu": 0.73}}], "relax": true,'
  [[ $start == *keep* ]] && segments=''
  echo "{$segments $start}" >"seeds/test/${start:1:5}.json"
done
cp "$work"/sim/end.{state,csv} test
cp "$work/sim/end.csv" spheres/spheres.csv
cut -d, -f 1-5 "$work/sim/end.csv" >seeds/spheres/resting.csv
cp "$work/sim/end.state" state/end.state
cp state/end.state state/state

run=$(dirname "${runs[0]}")
cp "$run"/* store/runs/key
jq -c '.key = "key"' "$run/run.json" >store/runs/key/run.json
echo '{"states": [], "warnings": ["w"], "files": {}}' >progress/progress.json
mkdir -p listed/tasks
cp "$work/listed/tasks/spec.json" listed/tasks
slim "$work/listed/tasks/tasks.json" | jq -c 'del(.provenance)' >listed/tasks/tasks.json
slim "$source/examples/paper/data/dataset/pictures.json" 18 >pictures/pictures.json

slim "$work/law/parameters.json" | jq -c 'del(.provenance, .parameters[].symbol, .parameters[].equation)' >parameters/parameters.json
cp parameters/parameters.json fitted_paths
slim "$source/fit/packing_prior.json" 2 | jq -c '. + {format: "grainlaw prior", format_version: 1}' >prior/prior.json
slim "$work/law/calibration.json" 2 | jq -c 'del(.provenance)' >calibration/calibration.json
slim "$work/law/fitted_paths.json" >fitted_paths/fitted_paths.json
slim "$work/study/study.json" >study/study.json
slim "$work/prediction/prediction.json" | jq -c 'del(.provenance.command) | .curves |= (.[:1] | map(.rows = 3))' >prediction/prediction.json
slim "$work/prediction/comparison.json" >comparison/comparison.json
cp prediction/prediction.json comparison
mkdir comparison/dem
jq -c 'del(.digest, .spec, .provenance, .tests[].sha256)' "$work/prediction/dem/dataset.json" >comparison/dem/dataset.json
for file in "$work"/prediction/dem/*.csv; do head -4 "$file" >"comparison/dem/$(basename "$file")"; done
for folder in prediction comparison; do
  head -4 "$work/prediction/reduced-law.csv" | tee $folder/reduced-law.csv >curve/curve.csv
done
jq -c '.dem = null' prediction/prediction.json >"$work/alone.json" && mv "$work/alone.json" prediction/prediction.json

for name in path spec test parameters prior dataset; do
  for file in "$name/$name.json" seeds/$name/*.json; do
    if [[ -e $file ]]; then cp "$file" "seeds/schema/$name-$(basename "$file")"; fi
  done
done
# Tables and particles of others, each with a mapping that names it.
mkdir -p {mapping,table,npy,npz,dump,dump-local,xyz,vtp,vtp-encoded,spheres-text,particles} seeds/{mapping,particles}
packing='"packings": {"p": {"seed": 1, "particles": 1000, "mean_radius": 1e-3, "stiffness": 1e8}}'
series() { echo "{\"source\": \"s\", $packing, \"tests\": [{\"name\": \"t\", \"role\": \"validation\", \"series\": {$1}}]}"; }
said='"sign": {"strain": "tension"}, "units": {"stress": "Pa"}'
series "\"file\": \"table.csv\", $said" | tee mapping/mapping.json >table/mapping.json
series "\"file\": \"table.npz\", $said" >npz/mapping.json
series "$said"', "file": "table.npy", "names": ["nu", "strain_xx", "strain_yy", "strain_zz", "stress_xx", "stress_yy", "stress_zz"]' >npy/mapping.json
head -7 "$source/examples/starters/dataset/D2-0.68-s1.csv" | tee mapping/table.csv >table/table.csv
"$grainlaw" export dataset --format npz -o "$work/npz" >/dev/null
cp "$work/npz/D2-0.68-s1.npz" npz/table.npz
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) c[$i] = i; next } { print $(c["nu"]), $(c["strain_xx"]), $(c["strain_yy"]),
  $(c["strain_zz"]), $(c["stress_xx[Pa]"]), $(c["stress_yy[Pa]"]), $(c["stress_zz[Pa]"]) }' table/table.csv |
  perl -e '@n = map { split } <STDIN>; $h = sprintf("%-117s\n", "{\x27descr\x27: \x27<f8\x27, \x27fortran_order\x27: False, \x27shape\x27: (6, 7), }");
    print "\x93NUMPY\x01\x00", pack("v", length $h), $h, pack("d<*", @n)' >npy/table.npy
jq -c '.series = {delimiter: "comma"} | .tests[0].path = {segments: [{mode: "D2", extent: {eps_dev: 0.3}}]} |
  .tests[0].path_tolerance = 0.01' mapping/mapping.json >seeds/mapping/path.json
particles() { echo "{\"source\": \"s\", \"packings\": {\"p\": {\"seed\": 1, \"stiffness\": 1e8}}, \"tests\": [{\"name\": \"t\", \"role\": \"validation\", \"path_tolerance\": 0.01, \"particles\": {$1}}]}"; }
for format in lammps-dump xyz vtp; do "$grainlaw" export "$work/framed" --format $format -o "$work/$format" >/dev/null; done
local='"format": "lammps-dump", "files": ["spheres.dump"], "contacts": {"files": ["contacts.dump"]}'
particles "$local" | tee particles/mapping.json >dump-local/mapping.json
particles '"format": "lammps-dump", "files": ["spheres.dump"], "contact_viscosity": 1, "density": 2000' | tee seeds/particles/viscous.json >dump/mapping.json
for folder in dump dump-local particles; do cp "$work/lammps-dump/frames.spheres.dump" $folder/spheres.dump; cp "$work/lammps-dump/frames.contacts.dump" $folder/contacts.dump; done
particles '"format": "xyz", "files": ["frames.xyz"]' >xyz/mapping.json
cp "$work/xyz/frames.xyz" xyz
particles '"format": "vtk", "files": ["spheres.vtp", "last.vtp"]' | tee vtp-encoded/mapping.json >vtp/mapping.json
cp "$work/vtp/frame-0000.spheres.vtp" vtp/spheres.vtp
cp "$work/vtp/frame-0001.spheres.vtp" vtp/last.vtp
cp vtp/last.vtp vtp-encoded
# numbers as base64 of their bytes behind their count, as VTK writes them
perl -0777 -pe 's{type="(Float64|Int64|Int32)"([^>]*)format="ascii">\n(.*?)\n</}{
    my %letter = (Float64 => "d<", Int64 => "q<", Int32 => "l<"); my $b = pack("$letter{$1}*", split(" ", $3)); my $head = "type=\"$1\"$2";
    $b = pack("V", length $b) . $b; my $pad = (3 - length($b) % 3) % 3; $b = pack("u", $b); $b =~ s/^.//mg; $b =~ s/\n//g;
    $b =~ tr#` -_#AA-Za-z0-9+/#; substr($b, length($b) - $pad) = "=" x $pad; "${head}format=\"binary\">\n$b\n</"}gse' \
  <vtp/spheres.vtp >vtp-encoded/spheres.vtp
particles '"format": "table", "files": ["spheres.txt", "last.txt"], "cells": {"file": "cells.csv", "lengths": ["Lx[m]", "Ly[m]", "Lz[m]"], "time": "time[s]"}' >spheres-text/mapping.json
cp "$source/examples/import/yade/sample/D2/000.spheres.txt" spheres-text/spheres.txt
cp "$source/examples/import/yade/sample/D2/003.spheres.txt" spheres-text/last.txt
sed -n '1,2p;5p' "$source/examples/import/yade/sample/D2.csv" >spheres-text/cells.csv
cat >seeds/json/all.json <<'JSON'
{"a": [0, -1, 1.5e-3, 1e308, 18446744073709551615, true, false, null, "\u00e9\ud83d\ude00\\\"\n", {}, []], "b": {"c": [[[]]]}} // end
JSON
echo '{"p": {"value": 0.5, "note": "x"}, "m": [[1e-300, -0.0], [0, 2.5e3]]}' >seeds/json/matrix.json
cp path/path.json seeds/json
cp -r seeds/json seeds/json-own
rm seeds/json-own/all.json
