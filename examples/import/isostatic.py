#!/usr/bin/env python3
"""isostatic.py NU DATASET: C* = C0 + C1 (nu/nu_c - 1)^alpha, Eq. (11), fitted to the ISO tests above NU with C0 = 6 and with C0 free.

The law holds C0 = 6, that of frictionless spheres. Prints C0, nu_c and the misfit, rms over the largest C*, of both as a row of Markdown.
"""
import json
import pathlib
import sys

import numpy as np
from scipy.optimize import least_squares


def main(least, folder):
    nu, c_star = [], []
    for test in json.loads((folder / "dataset.json").read_text())["tests"]:
        if test["name"].startswith("ISO"):
            table = np.genfromtxt(folder / f"{test['name']}.csv", delimiter=",", names=True, deletechars="")
            rows = (table["nu"] >= least) & np.isfinite(table["C_star"])
            nu.append(table["nu"][rows])
            c_star.append(table["C_star"][rows])
    nu, c_star = np.concatenate(nu), np.concatenate(c_star)
    cells = []
    for least_c0, most_c0 in ((6 - 1e-9, 6 + 1e-9), (3, 8)):
        fit = least_squares(lambda x: x[0] + x[1] * (nu / x[2] - 1) ** x[3] - c_star, [6, 8, 0.98 * nu.min(), 0.6],
                            bounds=([least_c0, 0.1, 0.5, 0.1], [most_c0, 30, nu.min(), 3]))
        misfit = np.sqrt(np.mean(fit.fun**2)) / c_star.max()
        cells += [f"{fit.x[0]:.2f}", f"{fit.x[2]:.4f}", f"{100 * misfit:.2f} %"]
    print("| " + " | ".join(cells) + " |")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__.splitlines()[0])
    main(float(sys.argv[1]), pathlib.Path(sys.argv[2]))
