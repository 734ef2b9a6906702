#!/usr/bin/env python3
"""averages.py FOLDER OUT [DIGITS [EVERY]]: a table of each test in FOLDER (run.sh's muMU) from its spheres and contacts.

What anybody would sum up with numpy, by the definitions alone and without grainlaw: box, volume fraction, stress from the
contact forces (compression positive), fabric (1/V) sum_p V_p sum_c n n, coordination of the spheres with four contacts or
more, the fraction of the others, mean overlap over mean radius. One row an instant, or for every second or third.
"""
import itertools
import json
import pathlib
import sys

import numpy as np

PAIRS = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
AXES = ["xx", "yy", "zz", "xy", "xz", "yz"]
HEADER = (["time[s]", "Lx[m]", "Ly[m]", "Lz[m]", "nu"] + [f"s{a}[Pa]" for a in AXES] + [f"F{a}" for a in AXES]
          + ["C_star", "rattlers", "mean_overlap"])


def frames(path):
    """(bounds of the box, numbers of each line) of a dump."""
    with open(path) as file:
        while file.readline():
            file.readline(), file.readline()
            lines = int(file.readline())
            file.readline()
            box = np.array([file.readline().split() for _ in range(3)], float)
            file.readline()
            yield box, np.array([file.readline().split() for _ in range(lines)], float)


def row(time, box, spheres, contacts):
    edges = box[:, 1] - box[:, 0]
    volume = edges.prod()
    x, r = spheres[:, 1:4], spheres[:, 4]
    solid = 4 / 3 * np.pi * r**3
    i, j = contacts[:, 0].astype(int) - 1, contacts[:, 1].astype(int) - 1
    branch = x[i] - x[j]
    branch -= edges * np.round(branch / edges)
    distance = np.linalg.norm(branch, axis=1)
    n = branch / distance[:, None]
    force = contacts[:, 4:7] + contacts[:, 7:10]  # on i: normal and tangential
    stress = np.einsum("ca,cb->ab", force, branch) / volume
    stress = (stress + stress.T) / 2
    fabric = np.einsum("c,ca,cb->ab", solid[i] + solid[j], n, n) / volume
    count = np.bincount(i, minlength=len(r)) + np.bincount(j, minlength=len(r))
    carries = count >= 4
    c_star = count[carries].mean() if carries.any() else np.nan
    overlap = (r[i] + r[j] - distance).mean() / r.mean() if len(i) else np.nan
    return [time, *edges, solid.sum() / volume, *[stress[p] for p in PAIRS], *[fabric[p] for p in PAIRS], c_star,
            1 - carries.mean(), overlap]


def main(folder, out, digits=6, every=1):
    for spheres in sorted(folder.glob("packing-*/*.spheres.dump")):
        name = spheres.name.removesuffix(".spheres.dump")
        if (spheres.parent / f"{name}.log").exists():  # not finished
            continue
        times = [line.split(",")[0] for line in (spheres.parent / f"{name}.csv").read_text().splitlines()[1:]]
        contacts = spheres.parent / f"{name}.contacts.dump"
        to = out / spheres.parent.name
        to.mkdir(parents=True, exist_ok=True)
        with open(to / f"{name}.csv", "w") as table:
            table.write(",".join(HEADER) + "\n")
            instants = zip(times, frames(spheres), frames(contacts))
            for time, (box, particles), (_, pairs) in itertools.islice(instants, 0, None, every):
                values = row(float(time), box, particles, pairs)
                table.write(",".join("" if np.isnan(v) else f"{v:.{digits}g}" for v in values) + "\n")
        packing = {"particles": len(particles), "size_width": 3, "mean_radius": float(f"{particles[:, 4].mean():.10g}")}
        (to / "packing.json").write_text(json.dumps(packing) + "\n")


if __name__ == "__main__":
    if not 3 <= len(sys.argv) <= 5:
        sys.exit(__doc__.splitlines()[0])
    main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), *map(int, sys.argv[3:]))
