"""Figures of own_data.sh: what two tables differ by, what two laws differ by, what the tables of friction say."""
import csv
import json
import math
import re
import sys

AXES = ["xx", "yy", "zz", "yz", "xz", "xy"]


def columns(file):
    with open(file, newline="") as text:
        rows = list(csv.reader(text))
    values = [[float(v) if v else math.nan for v in row] for row in rows[1:]]
    return {name.split("[")[0]: list(column) for name, column in zip(rows[0], zip(*values))}


def tensor(table, names, a):
    """Component `a` of each row; its name differs from house to house, and so does the order of its indices."""
    return next(table[name + axes] for name in names for axes in (a, a[::-1]) if name + axes in table)


def largest(ours, theirs, scale):
    if len(ours) != len(theirs):
        sys.exit("the tables have other rows")
    return max(abs(a - b) / s for a, b, s in zip(ours, theirs, scale))


def tables(kind, ours, theirs):
    ours, theirs = columns(ours), columns(theirs)
    if kind == "contacts":
        pairs = [("C_star", "C_star"), ("rattler_fraction", "rattlers"), ("mean_overlap", "mean_overlap")]
        return max(largest(ours[a], theirs[b], theirs[b]) for a, b in pairs if max(theirs[b]) > 0)
    # with friction sum f l is symmetric in equilibrium only; LAMMPS gives one of the two, we the mean
    normal_only = kind == "normal_stress"
    names = {"normal_stress": ["stress_", "s"], "stress": ["stress_", "s"], "fabric": ["fabric_", "F"]}[kind]
    trace = [sum(row) / 3 for row in zip(*(tensor(ours, names, a) for a in AXES[:3]))]
    sign = -1 if sum(tensor(theirs, names, a)[0] for a in AXES[:3]) < 0 else 1  # YADE's stress is tension positive
    axes = AXES[:3] if normal_only else AXES
    return max(largest(tensor(ours, names, a), [sign * v for v in tensor(theirs, names, a)], trace) for a in axes)


def parameters(theirs, ours, out):
    """Differences over the half width of their 95 % interval, sqrt((t_1 e_1)^2 + (t_2 e_2)^2)."""
    laws = [json.load(open(file))["parameters"] for file in (theirs, ours)]
    distances = []
    with open(out, "w") as table:
        table.write("| parameter | LAMMPS | grainlaw | difference / combined error | over half of the 95 % range |\n|---|---|---|---|---|\n")
        for name in laws[0]:
            found = [law[name] for law in laws]
            if any(p["status"] != "fitted" or "interval_95" not in p for p in found):
                continue
            difference = found[0]["value"] - found[1]["value"]
            error = math.hypot(*(p["standard_error"] for p in found))
            half = math.hypot(*((p["interval_95"][1] - p["interval_95"][0]) / 2 for p in found))
            distances.append(abs(difference) / half)
            cells = [f"{p['value']:.4g} ± {p['standard_error']:.2g}" for p in found]
            table.write(f"| `{name}` | {cells[0]} | {cells[1]} | {difference / error:+.1f} | {difference / half:+.2f} |\n")
    print("compared", len(distances))
    print("agree", sum(d <= 1 for d in distances) / len(distances))
    print("largest", round(max(distances), 3))


def main(kind, *arguments):
    if kind == "parameters":
        parameters(*arguments)
    else:
        print(f"{tables(kind, *arguments):.3g}")


if __name__ == "__main__":
    main(*sys.argv[1:])
