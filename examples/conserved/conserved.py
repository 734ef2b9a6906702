#!/usr/bin/env python3
"""Energy, momentum, volume and identity along the runs of run.sh: OUT/conserved.csv, OUT/conserved.svg, and the largest of each as
"NAME NUMBER".

  conserved.py OUT"""

import csv
import json
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams["svg.fonttype"] = "none"  # text stays text
import matplotlib.pyplot as plt
import numpy as np

out = pathlib.Path(sys.argv[1])
PANELS = (("energy", "energy residual over work", 1e-5), ("momentum", r"$|\sum m\,v|\;/\;\sum m\,|v|$", 1e-17), ("volume", r"$|V/V_0-1|$", 1e-17))


def conserved(folder):
    """Particle-steps so far, and each quantity at the states on the way."""
    run = json.load(open(folder / "simulation.json"))
    series, frames = (np.genfromtxt(folder / name, delimiter=",", names=True, deletechars="") for name in ("series.csv", "frames.csv"))
    time = frames["time[s]"]
    states = [np.load(file) for file in sorted((folder / "states").glob("frame-*.npz"))]
    assert len(states) == len(time), folder
    ids, radii, volume = states[0]["id"], states[0]["r"], np.linalg.det(states[0]["cell"])
    result = {"particle_steps": time / series["time[s]"][-1] * run["cost"]["steps"] * len(ids),
              "energy": np.abs(np.interp(time, series["time[s]"], series["energy_residual"])),
              "momentum": [], "volume": []}
    for state in states:
        assert np.array_equal(state["id"], ids) and np.array_equal(state["r"], radii), "spheres changed"
        momentum = radii[:, None] ** 3 * state["v"]
        size = np.linalg.norm(momentum, axis=1).sum()
        result["momentum"].append(np.linalg.norm(momentum.sum(axis=0)) / size if size > 0 else 0)
        result["volume"].append(abs(np.linalg.det(state["cell"]) / volume - 1))
    return {name: np.array(values) for name, values in result.items()}


RUNS = {"mixed": "mixed-0.1", "double": "double-0.1", "double.half_step": "double-0.05"}
results = {name: conserved(out / folder) for name, folder in RUNS.items()}
with open(out / "conserved.csv", "w", newline="") as file:
    writer = csv.writer(file)
    writer.writerow(["run", *results["mixed"]])
    for run, result in results.items():
        writer.writerows([run, *(f"{value:.6g}" for value in row)] for row in zip(*result.values()))

figure, axes = plt.subplots(1, len(PANELS), figsize=(11, 3.6), layout="constrained")
for axis, (name, label, least) in zip(axes, PANELS):
    for (run, result), style in zip(results.items(), ("-", "--", ":")):
        axis.semilogy(result["particle_steps"][1:], np.maximum(result[name][1:], 2 * least), style, lw=1, label=run.replace(".", ", ").replace("_", " the "))
    axis.set_xlabel("particle-steps")
    axis.set_ylabel(label)
    axis.set_ylim(least, 1e-2 if name == "energy" else 1e-5 if name == "momentum" else 1e-12)
    axis.grid(True, lw=.3)
axes[0].legend()
figure.savefig(out / "conserved.svg", metadata={"Date": None})

for run, result in results.items():
    print(f"conserved.{run}.particle_steps {result['particle_steps'][-1]:.4g}")
    for name, *_ in PANELS:
        print(f"conserved.{run}.{name} {result[name][1:].max():.3g}")
