#!/usr/bin/env python3
"""Own arrays to a law: element tests that somebody has as numpy arrays become a data set, the data set a law, the law a
prediction. Writes own_data/ and own_law/.

The arrays are a part of the paper's data here; they could come from any simulation: logarithmic strain since the start of the
test (tension positive), volume fraction, stress in Pa (compression positive), fabric, contacts."""

import csv
import json
import pathlib
import re

import numpy as np

import grainlaw

COLUMNS = ["segment", "strain_xx", "strain_yy", "strain_zz", "nu", "stress_xx[Pa]", "stress_yy[Pa]", "stress_zz[Pa]", "fabric_xx",
           "fabric_yy", "fabric_zz", "C_star", "rattler_fraction"]


def write_dataset(folder, tests):
    """`tests`: {name: (role, path, packing, {column: array})}; the axes of stress and strain are those of the box."""
    folder = pathlib.Path(folder)
    folder.mkdir(exist_ok=True)
    index = []
    for name, (role, path, packing, arrays) in tests.items():
        zero = np.zeros_like(arrays["nu"])
        columns = {column: arrays[column.split("[")[0]] for column in COLUMNS} | {"time[s]": np.arange(len(zero))}
        for tensor, unit in (("strain", ""), ("stress", "[Pa]"), ("fabric", "")):  # coaxial: no shear components
            columns |= {f"{tensor}_{component}{unit}": zero for component in ("yz", "xz", "xy")}
        with open(folder / f"{name}.csv", "w", newline="") as file:
            table = csv.writer(file)
            table.writerow(columns)
            for row in zip(*columns.values()):  # what is undefined is an empty field
                table.writerow(["" if np.isnan(value) else repr(float(value)) for value in row])
        index.append({"name": name, "role": role, "path": path, "packing": packing})
    (folder / "dataset.json").write_text(json.dumps({"tests": index}))


papers = grainlaw.Dataset(pathlib.Path(__file__).resolve().parent.parent / "paper/data/dataset")
mine = {}
for name in papers:
    test = papers[name]
    if not re.fullmatch(r"(ISO-unloading|D2-0\.(68|70|74|79)|D2-ISO-0\.(70|78))-s[123]", name):
        continue
    mine[name] = (test.role, test.path, {key: test.packing[key] for key in ("seed", "particles", "mean_radius", "stiffness")},
                  test.series)
write_dataset("own_data", mine)

try:
    law = grainlaw.calibrate(dataset="own_data", output="own_law").law
except grainlaw.NotConverged as error:
    print(error)
    law = error.result.law
for name in ("pressure.p0", "pressure.nu_c", "stress_ratio_max.Q_limit"):
    print(name, law[name].value, law[name].interval)
curve = law.predict({"initial": {"nu": 0.71}, "segments": [{"mode": "UNI", "extent": {"target_nu": 0.78}}]}, "evolution", bands=True)
print(f"uniaxial to nu = {curve.nu[-1]:.3f}: P* = {curve.P_star[-1]:.4f} ± {curve.P_star_mean95[-1]:.4f}")

assert len(grainlaw.Dataset("own_law")) == len(mine) and 0.63 < law["pressure.nu_c"].value < 0.68
assert curve.P_star[-1] > 2 * curve.P_star[0] > 0
