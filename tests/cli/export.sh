# grainlaw export, each format opened by its real consumer; simulate --frames; LAMMPS's files back through grainlaw import.
set -euo pipefail
grainlaw=$1
python=/usr/bin/python3
fail() { echo "FAIL: $*" >&2; exit 1; }

# --- frames: kept at equal strain, the run is the same with and without
cat >test.json <<'E1'
{"particles": 200, "seed": 3, "strain_rate": 2000, "rows": 10, "nu_end": 0.72, "initial": {"nu": 0.74},
 "segments": [{"mode": "D2", "extent": {"eps_dev": 0.02}}, {"mode": "ISO", "extent": {"target_nu": 0.75}}]}
E1
"$grainlaw" simulate test.json -o plain --quiet >text
"$grainlaw" simulate test.json -o run --frames 10 --quiet >text
cmp plain/series.csv run/series.csv || fail "frames moved the series"
cmp <(tail -n +2 plain/end.csv) <(tail -n +2 run/end.csv) || fail "frames moved the end"
(( $(ls run/frame-*.state | wc -l) == 21 && $(wc -l <run/frames.csv) == 22 )) || fail "21 frames: $(ls run)"
jq '.frames = 10' test.json >framed.json
"$grainlaw" simulate framed.json -o run --json --quiet | jq -e '.files | contains(["frames.csv", "frame-0020.state"])' >/dev/null || fail "the key"
# cut after each step of a checkpoint: the same frames
"$grainlaw" simulate framed.json -o cut --checkpoint 0 --quiet >text &
pid=$!
for _ in $(seq 200); do ls cut/runs/*/frame-0004.state >/dev/null 2>&1 && break; sleep 0.05; done
kill -INT $pid 2>/dev/null || true
wait $pid || true
"$grainlaw" simulate framed.json -o cut --quiet >text
cmp run/frames.csv cut/frames.csv || fail "frames of an interrupted run"
cmp <("$grainlaw" export run/frame-0013.state --format csv -o a >/dev/null; cat a/*.csv) \
    <("$grainlaw" export cut/frame-0013.state --format csv -o b >/dev/null; cat b/*.csv) || fail "frame 13"

# --- every format
for format in vtp xyz lammps-data lammps-dump vtkhdf npz csv; do
  "$grainlaw" export run --format $format -o out-$format >text || fail "$format"
  "$grainlaw" export run/end.state --format $format -o end-$format --json | jq -e '.states == 1 and (.files | length > 0)' >/dev/null || fail "$format of a state"
done
grep -q '2 series as csv\|1 series as csv' text || fail "$(cat text)"
before=$(sha256sum run/series.csv)
code=0
"$grainlaw" export run --format csv -o run 2>err >text || code=$?
[[ $code == 2 && $(sha256sum run/series.csv) == "$before" ]] && grep -q 'run/series.csv: would be overwritten' err || fail "over its source: $(cat err)"
for wrong in "nothing --format vtp" "run/series.csv --format vtp" "test.json --format xyz" "run --format pdf"; do
  code=0
  # shellcheck disable=SC2086
  "$grainlaw" export $wrong -o wrong 2>err >text || code=$?
  [[ $code == 2 && ! -e wrong && $(wc -l <err) == 1 ]] || fail "$wrong: $code $(cat err)"
done

# --- numpy
"$python" - <<'E2' || fail numpy
import csv, numpy as np
rows = list(csv.DictReader(open("run/series.csv")))
s = np.load("out-npz/series.npz")
assert s["P_star"].shape == (21,) and s["P_star"][-1] == float(rows[-1]["P_star"]) and np.isnan(s["lode_strain"][0])
e = np.load("end-npz/end.npz")
V = np.linalg.det(e["cell"])
sigma = np.einsum("ci,cj->ij", e["contact_force"], e["contact_branch"]) / V
ours = [float(rows[-1][f"stress_{k}[Pa]"]) for k in ("xx", "yy", "zz", "xy")]
assert np.allclose([sigma[0, 0], sigma[1, 1], sigma[2, 2]], ours[:3], rtol=1e-12, atol=0), (sigma, ours)
assert e["x"].shape == (200, 3) and (e["x"] >= 0).all() and (e["x"] <= e["cell"].diagonal()).all()
t = np.genfromtxt("out-csv/series.csv", delimiter=",", names=True, dtype=None, encoding=None)
assert t["P_star"][-1] == float(rows[-1]["P_star"]) and t["test"][0] == "series"
c = np.genfromtxt("end-csv/end.contacts.csv", delimiter=",", names=True)
assert len(c) == len(e["contact_force"])
E2

# --- VTK: points, contacts cut at the faces of the cell, the series of frames
if "$python" -c 'import vtk' 2>/dev/null; then
  "$python" - <<'E3' || fail vtk
import csv, os, numpy as np, vtk, xml.etree.ElementTree as ET
from vtk.util.numpy_support import vtk_to_numpy as arr
def read(name):
    r = vtk.vtkXMLPolyDataReader(); r.SetFileName(name); r.Update(); return r.GetOutput()
row = list(csv.DictReader(open("run/series.csv")))[-1]
s, c = read("out-vtp/frame-0020.spheres.vtp"), read("out-vtp/frame-0020.contacts.vtp")
e = np.load("end-npz/end.npz")
assert s.GetNumberOfPoints() == 200 and s.GetNumberOfVerts() == 200
assert (arr(s.GetPoints().GetData()) == e["x"]).all() and (arr(s.GetPointData().GetArray("radius")) == e["r"]).all()
assert arr(s.GetFieldData().GetArray("TimeValue"))[0] == float(row["time[s]"])
cell = arr(s.GetFieldData().GetArray("cell")).reshape(3, 3)
data = {k: arr(c.GetCellData().GetArray(k)) for k in ("force", "branch", "piece", "id1", "id2", "force_magnitude")}
first = data["piece"] == 0
assert first.sum() == len(e["contact_force"]) == round(float(row["C_r"]) * 200 / 2), "every contact once"
assert len(first) > first.sum(), "some cross a face"
sigma = np.einsum("ci,cj->ij", data["force"][first], data["branch"][first]) / np.linalg.det(cell)
assert np.allclose(sigma.diagonal(), [float(row[f"stress_{k}[Pa]"]) for k in ("xx", "yy", "zz")], rtol=1e-12, atol=0)
x = arr(c.GetPoints().GetData())
assert (x > -1e-12).all() and (x < cell.diagonal() + 1e-12).all(), "all pieces are in the cell"
lengths = np.linalg.norm(x[1::2] - x[::2], axis=1)  # of the pieces; those of a contact make its branch
contact = np.cumsum(first) - 1
assert np.allclose(np.bincount(contact, lengths), np.linalg.norm(data["branch"][first], axis=1), rtol=1e-12)
sets = ET.parse("out-vtp/contacts.pvd").getroot().findall("Collection/DataSet")
assert len(sets) == 21 and all(os.path.exists("out-vtp/" + d.get("file")) for d in sets)
t = [float(d.get("timestep")) for d in sets]
assert t == sorted(t) and t[0] == 0
h = vtk.vtkHDFReader(); h.SetFileName("out-vtkhdf/frame-0020.vtkhdf"); assert h.CanReadFile("out-vtkhdf/frame-0020.vtkhdf"); h.Update()
g = h.GetOutputDataObject(0)
assert g.GetNumberOfPoints() == g.GetNumberOfCells() == 200
assert (arr(g.GetPoints().GetData()) == e["x"]).all() and (arr(g.GetPointData().GetArray("radius")) == e["r"]).all()
# VTP as VTK writes it: text, base64, appended, compressed or not
for frame in ("0011", "0020"):
    s = read(f"out-vtp/frame-{frame}.spheres.vtp")
    for mode in ("Ascii", "Binary", "Appended", "Raw"):
        for compressor in ("None", "ZLib"):
            w = vtk.vtkXMLPolyDataWriter(); w.SetInputData(s); w.SetFileName(f"vtk-{mode}-{compressor}-{frame}.vtp")
            getattr(w, "SetDataModeTo" + mode.replace("Raw", "Appended"))(); w.SetEncodeAppendedData(mode != "Raw")
            getattr(w, "SetCompressorTypeTo" + compressor)(); w.Write()
E3
fi

# --- ASE
if "$python" -c 'import ase' 2>/dev/null; then
  "$python" - <<'E4' || fail ase
import numpy as np, ase.io
frames = ase.io.read("out-xyz/frames.xyz", ":")
e = np.load("end-npz/end.npz")
assert len(frames) == 21 and (frames[-1].positions == e["x"]).all() and (frames[-1].arrays["radius"] == e["r"]).all()
assert frames[-1].pbc.all() and (frames[-1].cell.array == e["cell"].T).all()
ase.io.write("ase.xyz", frames, format="extxyz")
E4
fi

# --- back by the import: the rows of the run itself
averages() { # name, particles (JSON without stiffness)
  cat >map-$1.json <<E5
{"source": "us", "packings": {"A": {"particles": 200, "mean_radius": 1e-3, "stiffness": 1e8}},
 "tests": [{"name": "$1", "role": "validation", "path_tolerance": 1e-3, "particles": $2}]}
E5
  "$grainlaw" import map-$1.json -o set-$1 >text 2>err || fail "$1: $(cat err)"
}
same() { # name, tolerance
  "$python" - "$1" "$2" <<'E6' || fail "averages of $1"
import csv, sys
ours, theirs = (list(csv.DictReader(open(f))) for f in ("run/series.csv", f"set-{sys.argv[1]}/{sys.argv[1]}.csv"))
assert len(ours) == len(theirs) == 21, (len(ours), len(theirs))
tolerance = float(sys.argv[2])
for a, b in zip(ours, theirs):
    for k in ["P_star", "nu", "F_v", "C_star", "rattler_fraction", "mean_overlap"] + [f"{t}_{c}" for t in ("stress", "fabric") for c in ("xx", "yy", "zz")]:
        k = next(t for t in a if t.split("[")[0] == k)
        assert abs(float(a[k]) - float(b[k])) <= tolerance * abs(float(a[k])), (k, a[k], b[k])
E6
}
averages dump '{"format": "lammps-dump", "files": ["out-lammps-dump/frames.spheres.dump"], "contacts": {"files": ["out-lammps-dump/frames.contacts.dump"]}}'
same dump 1e-12
averages law '{"format": "lammps-dump", "files": ["out-lammps-dump/frames.spheres.dump"], "contact_viscosity": 1}'
averages states '{"format": "state", "files": ["run/frame-*.state"]}'
averages xyz '{"format": "xyz", "files": ["'"$([[ -e ase.xyz ]] && echo ase.xyz || echo out-xyz/frames.xyz)"'"]}'
averages vtp '{"format": "vtk", "files": ["out-vtp/frame-*.spheres.vtp"]}'
for name in law states xyz vtp; do same $name 2e-3; done  # viscous forces by differences of the cell, or none
for file in vtk-*-0011.vtp; do # two frames, in all ways that VTK writes them
  [[ -e $file ]] || break
  averages one '{"format": "vtk", "files": ["'${file%0011.vtp}'*"]}'
  cut -d, -f2- set-one/one.csv >"${file%-0011.vtp}.rows"
  (( $(wc -l <set-one/one.csv) == 3 )) || fail "two frames"
done
(( $(sha256sum vtk-*.rows | cut -c1-64 | sort -u | wc -l) <= 1 )) || fail "VTK's ways of writing: $(tail -n +2 -q vtk-*.rows)"

# --- LAMMPS reads data and dump, and finds our stress
if command -v lmp >/dev/null; then
  cat >in.txt <<'E7'
units si
atom_style sphere
newton off
comm_modify vel yes
read_data end-lammps-data/end.data
pair_style granular
pair_coeff * * hooke 1e8 1 tangential linear_nohistory 0 0 damping velocity
neighbor 1e-4 bin
compute p all pressure NULL virial
compute radii all property/atom radius
compute d all reduce sum c_radii
thermo_style custom step atoms c_p[1] c_p[2] c_p[3] c_d
thermo_modify format float %.15g
run 0
read_dump end-lammps-dump/end.spheres.dump LAST x y z vx vy vz box yes replace yes
run 0
E7
  last=$(awk '/ITEM: TIMESTEP/ { getline; print }' end-lammps-dump/end.spheres.dump)
  sed -i "s/LAST/$last/" in.txt
  OMPI_MCA_btl=self lmp -in in.txt -log log.txt -screen none >out.txt 2>&1 </dev/null || fail "lmp: $(tail -n 3 log.txt out.txt)"
  "$python" - <<'E8' || fail lammps
import csv, numpy as np
rows = [l.split() for l in open("log.txt")]
rows = [[float(w) for w in r] for r in rows if len(r) == 6 and r[0].isdigit() and r[1] == "200"]
assert len(rows) == 2, rows
ours = list(csv.DictReader(open("run/series.csv")))[-1]
for r in rows:
    assert np.allclose(r[2:5], [float(ours[f"stress_{k}[Pa]"]) for k in ("xx", "yy", "zz")], rtol=1e-9, atol=0), (r, ours)
assert np.isclose(rows[0][5], np.load("end-npz/end.npz")["r"].sum(), rtol=1e-12)
E8
fi

# --- a data set
"$grainlaw" export set-dump --format npz -o set-npz >text
"$grainlaw" export set-dump --format csv -o set-csv --json | jq -e '.series == 1 and .files == ["series.csv"]' >/dev/null || fail "data set as csv"
"$python" -c 'import numpy; assert numpy.load("set-npz/dump.npz")["P_star"].shape == (21,)' || fail "data set as npz"
mkdir unlike  # a second series without the last column: one table cannot hold both, and no folder is left
cp set-dump/dump.csv unlike/
sed 's/,[^,]*$//' set-dump/dump.csv >unlike/dump2.csv
jq 'del(.digest) | .tests += [.tests[0] | .name = "dump2" | del(.sha256)]' set-dump/dataset.json >unlike/dataset.json
code=0
"$grainlaw" export unlike --format csv -o wrong 2>err || code=$?
[[ $code == 2 && ! -e wrong ]] && grep -q 'other columns' err || fail "$code $(ls wrong) $(cat err)"
code=0
"$grainlaw" export set-dump --format vtp -o wrong 2>err || code=$?
[[ $code == 2 && ! -e wrong ]] && grep -q 'holds no states' err || fail "$(cat err)"
