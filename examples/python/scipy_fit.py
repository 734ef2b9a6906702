#!/usr/bin/env python3
"""SciPy drives the law: two numbers of Eq. (20) are found again from series of one density by least squares, starting where
the law is wrong, with an error from the Jacobian. A filter of GrainLearning would call the same two lines: with_values, predict.

  scipy_fit.py [CALIBRATION]     without one the starters' data set is calibrated first"""

import pathlib
import sys

import numpy as np
from scipy.optimize import least_squares

import grainlaw


def calibration_of(arguments):
    if arguments:
        return grainlaw.CalibratedLaw(arguments[0]), grainlaw.Dataset(arguments[0])
    try:
        found = grainlaw.calibrate(dataset=pathlib.Path(__file__).resolve().parent.parent / "starters/dataset", output="law")
    except grainlaw.NotConverged as error:
        found = error.result
    return found.law, found.dataset


law, data = calibration_of(sys.argv[1:])
names = ["stress_ratio_max.Q_limit", "stress_rate.Q_limit"]
tests = [data[name] for name in data if name.startswith("D2-0.75-")]
scale = np.array([0.1, 30.0])


def misfit(x):
    trial = law.with_values(dict(zip(names, x * scale)))
    return np.concatenate([trial.predict(test, "reduced").s_par - test.series.s_par for test in tests])


bounds = np.array([law[name].bounds for name in names]).T / scale
fit = least_squares(misfit, x0=[0.5, 0.5], bounds=bounds, x_scale=[1, 1])
variance = 2 * fit.cost / (fit.fun.size - len(names)) * np.linalg.inv(fit.jac.T @ fit.jac)
for name, value, error in zip(names, fit.x * scale, np.sqrt(np.diag(variance)) * scale):
    print(f"{name:26} {value:8.4f} ± {error:.4f}   calibrated on all densities: {law[name].value:.4f}")
print(f"{fit.nfev} evaluations, RMS of s_par {np.sqrt(np.mean(fit.fun**2)):.4f}")
calibrated = misfit([law[name].value / s for name, s in zip(names, scale)])
assert fit.success and np.sum(fit.fun**2) <= np.sum(calibrated**2), "a fit of these tests alone fits them at least as well"
