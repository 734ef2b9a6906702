#!/usr/bin/env python3
"""mappings.py FOLDER MU: what `grainlaw import` must be told of the tests in FOLDER, of friction MU.

FOLDER is run.sh's muMU, with spheres and contacts, or what averages.py has made of it, tables. Written beside them are
calibration.json (what the law is fitted to) and uniaxial-NU.json (what it is judged on), mappings of `grainlaw import`.
"""
import json
import pathlib
import sys

STIFFNESS, DENSITY, TIME_STEP = 1e8, 2000, 3e-8


def of_particles(test):
    return {"files": [f"{test}.spheres.dump"], "contacts": {"files": [f"{test}.contacts.dump"]}}


def main(folder, friction):
    particles = any(folder.glob("packing-*/*.spheres.dump"))
    tests, packings = {}, {}
    for table in sorted(folder.glob("packing-*/*.csv")):
        if (table.parent / f"{table.stem}.log").exists():  # not finished
            continue
        seed = table.parent.name.removeprefix("packing-")
        packings[seed] = {"seed": int(seed), "stiffness": STIFFNESS}
        if friction > 0:
            packings[seed]["friction"] = friction
        if not particles:
            packings[seed] |= json.loads((table.parent / "packing.json").read_text())
        uniaxial = table.stem.startswith("UNI")
        where = f"{table.parent.name}/{table.stem}"
        test = {"name": f"{table.stem}-s{seed}", "role": "rehearsal" if uniaxial else "calibration", "packing": seed}
        if uniaxial:  # the same for all packings, as a prediction wants it
            start = {"nu": float(table.stem.removeprefix("UNI-")), "branch": "unloading"}
            test["path"] = {"initial": start, "segments": [{"mode": "UNI", "extent": {"target_nu": 0.82}}]}
        test |= {"particles": of_particles(where)} if particles else {"series": {"file": f"{where}.csv"}}
        tests.setdefault(table.stem.replace("UNI", "uniaxial") if uniaxial else "calibration", []).append(test)
    for name, of_name in tests.items():
        mapping = {"source": "LAMMPS (29 Sep 2021), examples/import/lammps", "packings": packings}
        if particles:
            normal, tangential = ([f"c_contact[{n}]" for n in range(first, first + 3)] for first in (3, 6))
            contacts = {"first": "c_pair[1]", "second": "c_pair[2]", "force": normal, "tangential_force": tangential}
            mapping["particles"] = {"format": "lammps-dump", "contacts": contacts, "time_step": TIME_STEP,
                                    "stiffness": STIFFNESS, "density": DENSITY}
        else:
            mapping["series"] = {"sign": {"stress": "compression"}}
        mapping["tests"] = of_name
        text = json.dumps(mapping | {"tests": "TESTS"}, indent=2)
        lines = ",\n".join("    " + json.dumps(test) for test in of_name)
        (folder / f"{name}.json").write_text(text.replace('"TESTS"', "[\n" + lines + "\n  ]") + "\n")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__.splitlines()[0])
    main(pathlib.Path(sys.argv[1]), float(sys.argv[2]))
