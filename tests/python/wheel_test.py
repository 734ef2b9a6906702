"""pip install . from the checkout into a fresh environment, without a network: it imports, and computes."""

import os
import pathlib
import subprocess
import sys
import unittest

try:
    import ensurepip  # noqa: F401
    import pip  # noqa: F401
except ImportError:
    sys.exit(77)

SOURCE, BUILD = os.environ["GRAINLAW_SOURCE_DIR"], os.environ["GRAINLAW_BUILD_DIR"]


class Wheel(unittest.TestCase):
    def test_install(self):
        clean = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        run = lambda *command: subprocess.run(command, capture_output=True, text=True, env=clean)
        made = run(sys.executable, "-m", "venv", "--system-site-packages", "fresh")
        self.assertEqual(made.returncode, 0, made.stderr)
        # the build that is there: compiling anew takes minutes, and is tried by tests/acceptance
        installed = run("fresh/bin/pip", "install", "--no-index", "--config-settings", f"build-dir={BUILD}", SOURCE)
        self.assertEqual(installed.returncode, 0, installed.stdout + installed.stderr)
        said = run("fresh/bin/python", "-c", "import grainlaw; print(grainlaw.__file__, grainlaw.__version__)")
        self.assertTrue(said.stdout.startswith(str(pathlib.Path("fresh").resolve())), said.stdout + said.stderr)
        files = run("fresh/bin/pip", "show", "--files", "grainlaw").stdout
        for name in ("py.typed", "_core.pyi", "__init__.py", "LICENSE"):
            self.assertIn(name, files)
        removed = run("fresh/bin/pip", "uninstall", "--yes", "grainlaw")
        self.assertEqual(removed.returncode, 0, removed.stderr)
        self.assertFalse(list(pathlib.Path("fresh").rglob("*grainlaw*")))


if __name__ == "__main__":
    unittest.main()
