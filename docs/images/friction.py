#!/usr/bin/env python3
"""docs/images/friction.py OUT.svg: tests of LAMMPS with friction 0, 0.1 and 0.5, from the tables in examples/import/lammps/data.

Left C* and P* of isotropic unloading, right stress ratio and fabric of D2 to a deviatoric strain of 0.8. Mean over the packings.
"""
import pathlib
import sys

import matplotlib
import numpy as np

matplotlib.use("svg")
matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "grainlaw", "font.size": 8, "font.family": "sans-serif"})
import matplotlib.pyplot as plt  # noqa: E402  after the choice of its backend

DATA = pathlib.Path(__file__).resolve().parents[2] / "examples/import/lammps/data"
STRESS_UNIT = 1e8 / 2e-3  # k/(2<r>) [Pa]
SHEAR = {"0": "D2-0.71", "0.1": "D2-0.69", "0.5": "D2-0.71"}
COLOURS = {"0": "#0072b2", "0.1": "#e69f00", "0.5": "#d55e00"}


def mean(folder, test):
    """Columns by their names, averaged over the packings."""
    tables = [np.genfromtxt(file, delimiter=",", names=True, deletechars="") for file in sorted(folder.glob(f"packing-*/{test}.csv"))]
    rows = min(len(table) for table in tables)
    return {name.split("[")[0]: np.mean([table[name][:rows] for table in tables], axis=0) for name in tables[0].dtype.names}


figure, axes = plt.subplots(1, 4, figsize=(10, 2.7), constrained_layout=True)
for mu, colour in COLOURS.items():
    iso = mean(DATA / f"mu{mu}", "ISO")
    pressure = (iso["sxx"] + iso["syy"] + iso["szz"]) / 3 / STRESS_UNIT
    jammed = pressure > 1e-4
    axes[0].plot(iso["nu"][jammed], iso["C_star"][jammed], color=colour)
    axes[1].plot(iso["nu"], pressure, color=colour)
    shear = mean(DATA / f"mu{mu}-long", SHEAR[mu])
    strain = np.sqrt(3) * np.log(shear["Lx"] / shear["Lx"][0])
    along = np.sqrt(3) / 2  # of a deviator along D2
    axes[2].plot(strain, along * (shear["szz"] - shear["sxx"]) / (shear["sxx"] + shear["syy"] + shear["szz"]) * 3, color=colour)
    axes[3].plot(strain, along * (shear["Fzz"] - shear["Fxx"]), color=colour, label=f"friction {mu}, ν = {SHEAR[mu][3:]}")
axes[0].axhline(6, color="grey", linewidth=0.7, linestyle=":")
for axis, x, y in zip(axes, ["ν, ISO unloading"] * 2 + ["deviatoric strain, D2"] * 2, ["C*", "P*", "s", "F"]):
    axis.set_xlabel(x)
    axis.set_title(y, loc="left")
    axis.spines[["top", "right"]].set_visible(False)
for axis in axes[2:]:
    axis.axvline(0.26, color="grey", linewidth=0.7, linestyle=":")
axes[3].legend(frameon=False, fontsize=7)
figure.savefig(sys.argv[1], metadata={"Date": None})
