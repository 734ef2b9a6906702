"""What the tests of the Python module begin with: the starters' data set, and the law that is calibrated on it."""

import os
import pathlib

import grainlaw

SOURCE = pathlib.Path(os.environ["GRAINLAW_SOURCE_DIR"])
DATASET = SOURCE / "examples/starters/dataset"
UNI = {"initial": {"nu": 0.70}, "segments": [{"mode": "UNI", "extent": {"target_nu": 0.78}}]}
TURN = {"initial": {"nu": 0.74}, "segments": [{"mode": "D2", "extent": {"eps_dev": 0.06}},
                                            {"mode": "D3", "reverse": True, "extent": {"eps_dev": 0.05}},
                                            {"mode": "ISO", "extent": {"eps_vol": 0.02}}]}


def calibrated(output="law"):
    """As grainlaw calibrate --dataset: what does not converge is said by an exception that has the result."""
    try:
        return grainlaw.calibrate(dataset=DATASET, output=output)
    except grainlaw.NotConverged as error:
        return error.result
