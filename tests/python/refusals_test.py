"""What is not valid is InvalidInput that names the argument, and leaves nothing behind."""

import os
import pathlib
import unittest

import numpy as np

import grainlaw
from scene import STARTERS, UNI, calibrated, part_of_the_papers_data

NAN, HUGE = float("nan"), 10**30


def cyclic():
    path = dict(UNI)
    path["initial"] = path
    return path


def with_nu(nu):
    return UNI | {"initial": {"nu": nu}}


class Refusals(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.law = calibrated(dataset=part_of_the_papers_data()).law

    def refused(self, said, call, *arguments, **keywords):
        before = sorted(pathlib.Path(".").rglob("*"))
        with self.assertRaises(grainlaw.InvalidInput) as raised:
            call(*arguments, **keywords)
        self.assertRegex(str(raised.exception), said)
        self.assertNotIn("\n", str(raised.exception))
        self.assertEqual(sorted(pathlib.Path(".").rglob("*")), before)

    def test_documents(self):
        for said, path in [("initial.nu: nan is not finite", with_nu(NAN)), ("initial.nu: -inf is not finite", with_nu(-np.inf)),
                           ("initial.nu", with_nu("dense")), ("initial.nu", with_nu(None)), ("initial.nu", with_nu(True)),
                           ("beyond the range", with_nu(HUGE)), ("beyond the range", with_nu(-(10**5000))),
                           ("initial.nu", with_nu(2**64 - 1)), ("initial.nu", with_nu(np.float32("nan"))),
                           ("type set", with_nu({1})), ("type complex", with_nu(1j)), ("initial.nu", with_nu(np.complex128(1))),
                           ("nested deeper", cyclic()), ("a key: is of type int", {1: 2}), ("nu.*surrogate|nu.*UTF-8|nu", with_nu("\ud800")),
                           ("surprise", UNI | {"surprise": 1}), ("segments", {"initial": {"nu": 0.7}}),
                           ("dict|type list", [UNI]), ("type NoneType", None), ("type int", 3), ("is empty", ""), ("is empty", b""),
                           ("null", "a\0b"), ("none.json", "none.json"), ("none.json", pathlib.Path("none.json")),
                           ("folder", "."), ("jammed", with_nu(0.5)), ("<= 0.9", with_nu(0.95))]:
            with self.subTest(said=said):
                self.refused(said, self.law.predict, path)
                self.refused(said, grainlaw.predict, self.law, path, "out")
        self.refused("spec: particles: -1|spec: particles", grainlaw.calibrate, {"particles": -1}, output="out")
        self.refused("spec: strain_rate: nan", grainlaw.calibrate, {"strain_rate": NAN}, output="out")
        self.refused("misses SPEC", grainlaw.calibrate, output="out")
        self.refused("test: particles", grainlaw.simulate, {"particles": 1.5}, "out")
        self.refused("none", grainlaw.calibrate, dataset="none", output="out")
        self.refused("none", grainlaw.report, "none")
        self.refused("law", grainlaw.predict, 7, UNI, "out")

    def test_a_law_whose_file_has_changed(self):
        self.law.save("changing.json")
        law = grainlaw.CalibratedLaw("changing.json")
        law.with_values({"pressure.p0": 1.1 * law["pressure.p0"].value}).save("changing.json")
        self.refused("changing.json has changed since it was read", grainlaw.predict, law, UNI, "out")

    def test_a_measured_strain_history_that_is_not_there(self):
        self.refused("history.csv", self.law.predict, {"initial": {"nu": 0.7}, "strain_csv": pathlib.Path("history.csv")})

    def test_settings(self):
        for said, keywords in [("model", {"model": "best"}), ("model: is of type int", {"model": 3}), ("points", {"points": 0}),
                               ("points", {"points": 1.5}), ("points", {"points": HUGE}), ("points", {"points": 10**5000}),
                               ("points", {"points": True}), ("start", {"start": "here"})]:
            self.refused(said, self.law.predict, UNI, **keywords)
        for said, keywords in [("threads", {"threads": 0}), ("threads", {"threads": HUGE}), ("threads", {"threads": "two"}),
                               ("progress", {"progress": 1}), ("loss", {"loss": "none"}), ("starts", {"starts": -1}),
                               ("coupling", {"coupling": "weak"}), ("no.json", {"prior": "no.json"}), ("output", {"output": 3}),
                               ("output", {"output": None})]:
            self.refused(said, grainlaw.calibrate, dataset=STARTERS, **({"output": "out"} | keywords))
        self.refused("excludes", grainlaw.predict, self.law, UNI, "out", dem=True, against=STARTERS)
        self.refused("dem=True", grainlaw.predict, self.law, UNI, "out", seeds=[1])
        self.refused("seeds", grainlaw.predict, self.law, UNI, "out", dem=True, spec={"particles": 64}, seeds=["one"])
        self.refused("initial", grainlaw.predict, self.law, UNI, "out", start="measured")

    def test_values(self):
        for said, values in [("p0", {"p0": 1}), ("p0: got nan", {"pressure.p0": NAN}), ("bounds", {"pressure.p0": -1}),
                             ("p0: got", {"pressure.p0": "1"}), ("type int", {1: 2}), ("p0: got True", {"pressure.p0": True})]:
            self.refused(said, self.law.with_values, values)
        self.refused("pressure", self.law.__getitem__, "pressure")

    def test_batches(self):
        good = np.zeros((3, 2, 6))
        nan, inf = good.copy(), good.copy()
        nan[1, 1, 2], inf[2, 0, 5] = np.nan, np.inf
        for said, strain in [(r"nan at \(1, 1, 2\)", nan), (r"inf at \(2, 0, 5\)", inf), ("dimensions", good[0]), ("shape", good[..., :5]),
                             ("dtype", good.astype(complex)), ("dtype", good.astype(str)), ("dtype", good.astype(object)),
                             ("dtype", good.astype(bool)), ("no array|dtype", [[[1, 2], [3]]]), ("dtype|no array", None),
                             ("dtype", "strain"), ("masked", np.ma.masked_array(good, good == 0)),
                             ("path 0, step 0: the volume fraction", good - 1), ("path 0, step 0: the volume fraction", good + 1e9)]:
            self.refused(said, self.law.predict_batch, strain, 0.74)
        for said, nu in [("nu: has 2 values for 3", [0.7, 0.7]), ("nu: has 2 dimensions", np.full((3, 1), 0.7)), ("nan", [0.7, NAN, 0.7]),
                         ("nu: got nan", NAN), ("path 1", [0.7, 0.5, 0.7]), ("outside", [0.7, 0.7, 7]), ("dtype", ["a", "b", "c"]),
                         ("volume fraction 1e.30 is outside", HUGE), ("dtype|no array|dimensions", None)]:
            self.refused(said, self.law.predict_batch, good, nu)
        for said, keywords in [("accuracy", {"accuracy": 0}), ("accuracy", {"accuracy": NAN}), ("accuracy", {"accuracy": "fine"}),
                               ("accuracy", {"accuracy": 1}), ("threads", {"threads": -1}), ("model", {"model": "none"})]:
            self.refused(said, self.law.predict_batch, good, 0.74, **keywords)

    def test_bands_where_the_law_decides(self):
        path = {"initial": {"nu": 0.74}, "segments": [{"mode": "UNI", "extent": {"target_P_star": 0.01}}]}
        self.refused("bands", self.law.predict, path, bands=True)
        self.refused("reduced", self.law.predict, path, "reduced")


if __name__ == "__main__":
    unittest.main()
