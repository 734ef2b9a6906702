"""The stubs say what is there (mypy's stubtest), users are checked by them, and slips are found."""

import os
import pathlib
import subprocess
import sys
import unittest

try:
    import mypy.stubtest  # noqa: F401
except ImportError:
    sys.exit(77)

PACKAGE = pathlib.Path(os.environ["GRAINLAW_BUILD_DIR"]) / "python"
GOOD = """
import pathlib
import grainlaw

law: grainlaw.CalibratedLaw = grainlaw.calibrate({"seeds": [1]}, output=pathlib.Path("out"), progress=lambda f, text: print(f)).law
pressure = law.predict(grainlaw.Path("path.json"), "memory").P_star.max()
error = law["pressure.p0"].standard_error or 0.0
half: float = 2 * error
"""
SLIPS = ['law.predict("path.json", "best")', 'law["pressure.p0"].standard_error + 1', 'grainlaw.calibrate(outptu="x")',
         'law.converged = True', 'grainlaw.report(1)']


class Types(unittest.TestCase):
    def mypy(self, text):
        pathlib.Path("used.py").write_text(text)
        return subprocess.run([sys.executable, "-m", "mypy", "--strict", "used.py"], capture_output=True, text=True,
                              env=os.environ | {"MYPYPATH": str(PACKAGE)})

    def test_stubtest(self):
        # pybind11 tells the signature of no __init__, and gives one that refuses to those that have none
        pathlib.Path("unknown").write_text(r"grainlaw\..*\.__init__")
        found = subprocess.run([sys.executable, "-m", "mypy.stubtest", "--allowlist", "unknown", "grainlaw"], capture_output=True, text=True,
                               env=os.environ | {"MYPYPATH": str(PACKAGE)})
        self.assertEqual(found.returncode, 0, found.stdout + found.stderr)

    def test_users(self):
        found = self.mypy(GOOD)
        self.assertEqual(found.returncode, 0, found.stdout)
        found = self.mypy(GOOD + "\n".join(SLIPS) + "\n").stdout
        for line, slip in enumerate(SLIPS, GOOD.count("\n") + 1):
            self.assertRegex(found, rf"used.py:{line}: error", slip)

    def test_the_package_says_that_it_has_types(self):
        self.assertTrue((PACKAGE / "grainlaw/py.typed").exists())


if __name__ == "__main__":
    unittest.main()
