#!/usr/bin/env python3
"""python_law.py LAW_CALLS PARAMETERS.json: what Python adds to the same calls in C++ (tests/bench/law_calls.cpp). Both run in turns,
five times, and the least of each counts, so that a slow moment hits neither alone. Prints "NAME NUMBER" lines; figures of a
quiet machine only."""

import collections
import subprocess
import sys
import time

import numpy as np

import grainlaw

PATHS, START, STRAIN = 100_000, 0.71, 0.02
program, file = sys.argv[1:]
law = grainlaw.CalibratedLaw(file)
path = grainlaw.Path({"initial": {"nu": START}, "segments": [{"mode": "UNI", "extent": {"eps_dev": STRAIN}}]})
strain = np.zeros((PATHS, 1, 6))
strain[:, 0, 2] = -STRAIN * (1 + np.arange(PATHS) / PATHS) / 2
nu = np.full(PATHS, START)


def least(repeats, work):
    best = float("inf")
    for _ in range(repeats):
        begin = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - begin)
    return best


of_python, of_cpp = collections.defaultdict(lambda: float("inf")), collections.defaultdict(lambda: float("inf"))
for _ in range(5):
    for line in subprocess.run([program, file], check=True, capture_output=True, text=True).stdout.splitlines():
        name, value = line.split()
        of_cpp[name] = min(of_cpp[name], float(value))
    for rung in ("reduced", "evolution"):
        for points in (1, 200):
            name = f"{rung}.{points}"
            seconds = least(3000, lambda: law.predict(path, rung, points=points))
            of_python[name] = min(of_python[name], 1e6 * seconds)
    of_python["batch"] = min(of_python["batch"], least(5, lambda: law.predict_batch(strain, nu, "evolution").P_star))

for name in of_python:
    if name != "batch":
        print(f"{name} C++ {of_cpp[name]:.2f} us, Python {of_python[name]:.2f} us")
        print(f"overhead.{name} {of_python[name] - of_cpp[name]:.2f}")
column = least(100_000, lambda p=law.predict(path, "reduced"): p.P_star)
print(f"column {1e6 * column:.2f}")
print(f"batch C++ {of_cpp['batch.arrays']:.3f} s from arrays, {of_cpp['batch.segments']:.3f} s from segments, Python {of_python['batch']:.3f} s")
print(f"batch.speed {min(of_cpp['batch.arrays'], of_cpp['batch.segments']) / of_python['batch']:.3f}")
