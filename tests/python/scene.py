"""What the tests of the Python module begin with: a part of the paper's data, and the law that is calibrated on it."""

import json
import os
import pathlib
import re
import shutil

import grainlaw

SOURCE = pathlib.Path(os.environ["GRAINLAW_SOURCE_DIR"])
STARTERS = SOURCE / "examples/starters/dataset"
PART = re.compile(r"(ISO-unloading|D2-0\.(68|70|74|79)|D2-ISO-0\.(70|78))-s[123]")
UNI = {"initial": {"nu": 0.70}, "segments": [{"mode": "UNI", "extent": {"target_nu": 0.78}}]}
TURN = {"initial": {"nu": 0.74}, "segments": [{"mode": "D2", "extent": {"eps_dev": 0.06}},
                                            {"mode": "D3", "reverse": True, "extent": {"eps_dev": 0.05}},
                                            {"mode": "ISO", "extent": {"eps_vol": 0.02}}]}


def part_of_the_papers_data(folder="part"):
    """Enough for every rung of the law, on three packings."""
    whole, part = SOURCE / "examples/paper/data/dataset", pathlib.Path(folder)
    part.mkdir()
    tests = [test for test in json.loads((whole / "dataset.json").read_text())["tests"] if PART.fullmatch(test["name"])]
    for test in tests:
        shutil.copy(whole / f"{test['name']}.csv", part)
    (part / "dataset.json").write_text(json.dumps({"tests": tests}))
    return part


def calibrated(output="law", dataset=STARTERS):
    """As grainlaw calibrate --dataset: what does not converge is said by an exception that has the result."""
    try:
        return grainlaw.calibrate(dataset=dataset, output=output)
    except grainlaw.NotConverged as error:
        return error.result
