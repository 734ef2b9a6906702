#!/usr/bin/env python3
"""A sweep: the pressure that uniaxial compression reaches over where it starts and how far it goes, 10,000 paths in one call; and
how far each parameter of the pressure moves it. Writes sweep.csv.

  sweep.py [CALIBRATION]     without one the starters' data set is calibrated first"""

import pathlib
import sys

import numpy as np

import grainlaw


def law_of(arguments):
    if arguments:
        return grainlaw.CalibratedLaw(arguments[0])
    try:
        return grainlaw.calibrate(dataset=pathlib.Path(__file__).resolve().parent.parent / "starters/dataset", output="law").law
    except grainlaw.NotConverged as error:
        return error.result.law


law = law_of(sys.argv[1:])
starts, strains = np.linspace(0.69, 0.75, 100), np.linspace(0.001, 0.08, 100)
nu, axial = (grid.ravel() for grid in np.meshgrid(starts, strains, indexing="ij"))
strain = np.zeros((nu.size, 1, 6))
strain[:, 0, 2] = -axial  # zz, compression

P = law.predict_batch(strain, nu).P_star[:, 0]
np.savetxt("sweep.csv", np.column_stack([nu, axial, P]), delimiter=",", header="nu,axial_strain,P_star", comments="")
grid = P.reshape(100, 100)
assert (np.diff(grid, axis=1) > 0).all(), "pressure rises with compression"
assert (np.diff(grid, axis=0) > 0).all(), "and with the density it starts from"

for name in ("pressure.p0", "pressure.gamma_p", "pressure.nu_c"):
    value = law[name].value
    step = 1e-4 * max(abs(value), 1e-2)
    moved = law.with_values({name: value + step}).predict_batch(strain, nu).P_star[:, 0]
    print(f"{name:18} d ln P*/d parameter: {np.mean((moved - P) / P / step):10.4f}")
