#!/usr/bin/env python3
"""Stress ratio and fabric over deviatoric strain in D2 at several densities, from the shipped data of examples/paper: the curves
whose limits and rates Eq. (20) of Imole et al. (2013) fits, mean and scatter of five packings. Writes d2.svg.

  paper_figure.py [DATASET]"""

import collections
import pathlib
import sys

import matplotlib.pyplot as plt
import numpy as np

import grainlaw

here = pathlib.Path(__file__).resolve().parent
data = grainlaw.Dataset(sys.argv[1] if len(sys.argv) > 1 else here.parent / "paper/data/dataset")

packings = collections.defaultdict(list)  # series by density
for name in data:
    path = data[name].path
    if path["segments"][0].get("mode") == "D2" and len(path["segments"]) == 1 and path["initial"]["branch"] == "unloading":
        packings[path["initial"]["nu"]].append(data[name].series)

figure, axes = plt.subplots(1, 2, figsize=(10, 4), sharex=True, layout="constrained")
for axis, quantity, label in zip(axes, ("s_dev", "F_dev"), (r"$s_{dev}$ [–]", r"$F_{dev}$ [–]")):
    steady = []
    for nu, all_series in sorted(packings.items()):
        values = np.array([series[quantity] for series in all_series])
        mean, scatter = values.mean(axis=0), values.std(axis=0, ddof=1)
        strain = all_series[0].eps_dev
        line, = axis.plot(strain, mean, label=f"ν = {nu:.2f}")
        axis.fill_between(strain, mean - scatter, mean + scatter, color=line.get_color(), alpha=0.2, linewidth=0)
        steady.append(mean[strain > 0.15].mean())
    axis.set_xlabel(r"$\varepsilon_{dev}$ [–]")
    axis.set_ylabel(label)
    print(quantity, "steady:", " ".join(f"{nu:.2f}:{value:.4f}" for nu, value in zip(sorted(packings), steady)))
    # what the paper says of both: the denser, the less
    assert len(steady) >= 5 and steady[0] > 1.2 * steady[-1] and np.corrcoef(sorted(packings), steady)[0, 1] < -0.8
axes[0].legend(ncols=2, fontsize="small")
figure.savefig("d2.svg")
