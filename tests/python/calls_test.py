"""The commands as functions: results and files, progress, exceptions as exit codes, interruption and going on."""

import json
import logging
import os
import pathlib
import signal
import subprocess
import sys
import textwrap
import threading
import time
import unittest

import numpy as np

import grainlaw
from scene import STARTERS, calibrated

# A preparation that is short, and tests that take minutes.
LONG = {"particles": 64, "seeds": [1], "strain_rate": 5000, "rows": 20, "densities": [0.78], "nu_end": 0.76,
        "tests": [{"mode": "ISO", "role": "calibration"}, {"mode": "D2", "strain": 0.01, "role": "calibration"},
                  {"name": "long", "segments": [{"mode": "D2", "extent": {"eps_dev": 100}}], "role": "validation"}]}
TEST = {"particles": 64, "strain_rate": 5000, "rows": 20, "seed": 3, "initial": {"nu": 0.78},
        "segments": [{"mode": "D2", "extent": {"eps_dev": 0.02}}]}
QUIET = {"threads": 2}


def finished(folder):
    return sorted(str(file) for file in pathlib.Path(folder).glob("runs/*/run.json"))


class Simulate(unittest.TestCase):
    def test_dict_and_file_are_the_same_test_as_the_programs(self):
        told = []
        by_dict = grainlaw.simulate(TEST, "by_dict", progress=lambda fraction, text: told.append((fraction, text)), **QUIET)
        os.makedirs("elsewhere", exist_ok=True)
        with open("elsewhere/test.json", "w") as text:
            json.dump(TEST, text)
        subprocess.run([os.environ["GRAINLAW"], "simulate", "elsewhere/test.json", "-o", "by_program", "--quiet"], check=True,
                       stdout=subprocess.DEVNULL)
        by_file = grainlaw.simulate(pathlib.Path("elsewhere/test.json"), b"by_file", **QUIET)
        for folder in ("by_dict", "by_file"):
            self.assertEqual(pathlib.Path(folder, "series.csv").read_text(), pathlib.Path("by_program/series.csv").read_text())
        np.testing.assert_array_equal(by_dict.series.P_star, by_file.series.P_star)
        self.assertEqual(by_dict.summary["rows"], by_dict.series.rows)
        self.assertTrue(told)
        self.assertTrue(all(0 <= fraction <= 1 and isinstance(text, str) for fraction, text in told))

    def test_files_in_a_dict_are_relative_to_the_current_folder_in_a_file_to_its_own(self):
        spheres = grainlaw.simulate(TEST, "first", **QUIET)
        os.makedirs("given", exist_ok=True)
        os.replace("first/end.csv", "given/end.csv")
        test = {"spheres": "end.csv", "cell": spheres.summary["cell"], "strain_rate": 5000, "rows": 5,
                "segments": [{"mode": "D2", "extent": {"eps_dev": 0.001}}]}
        with open("given/test.json", "w") as text:
            json.dump(test, text)
        of_file = grainlaw.simulate("given/test.json", "of_file", **QUIET)
        with self.assertRaisesRegex(grainlaw.InvalidInput, "end.csv"):
            grainlaw.simulate(test, "of_dict", **QUIET)
        test["spheres"] = pathlib.Path("given") / "end.csv"
        test["cell"] = np.array(test["cell"])
        np.testing.assert_array_equal(grainlaw.simulate(test, "of_dict", **QUIET).series.P_star, of_file.series.P_star)


class Calibrate(unittest.TestCase):
    def test_what_does_not_converge_is_an_exception_with_the_result(self):
        little = {key: value for key, value in LONG.items() if key != "tests"} | {"tests": LONG["tests"][:2], "seeds": [1, 2]}
        try:
            result = grainlaw.calibrate(little, output="little")
        except grainlaw.NotConverged as error:
            result = error.result
            self.assertEqual(error.exit_code, 3)
            self.assertFalse(result.law.converged)
        except grainlaw.InvalidInput:  # 64 spheres may be no packing at all
            return
        self.assertTrue(os.path.exists("little/parameters.json"))
        self.assertEqual(len(result.dataset), 4)

    def test_messages_go_to_the_logger(self):
        with self.assertLogs("grainlaw", logging.WARNING) as logs:
            calibrated("logged")
        self.assertRegex("\n".join(logs.output), "warning: ")

    def test_report(self):
        calibrated("reported")
        numbers = grainlaw.report("reported", "page.html")
        self.assertEqual(numbers, json.loads(subprocess.run([os.environ["GRAINLAW"], "report", "reported", "--json"],
                                                            check=True, capture_output=True).stdout))
        self.assertIn("<html", pathlib.Path("page.html").read_text()[:200])


class Exceptions(unittest.TestCase):
    def test_they_are_the_exit_codes(self):
        codes = [(grainlaw.Error, RuntimeError, 1), (grainlaw.InvalidInput, ValueError, 2), (grainlaw.NotConverged, grainlaw.Error, 3),
                 (grainlaw.Interrupted, KeyboardInterrupt, 130)]
        for kind, base, code in codes:
            self.assertTrue(issubclass(kind, base))
            self.assertEqual((kind.exit_code, kind.__module__), (code, "grainlaw"))
        self.assertTrue(issubclass(grainlaw.InvalidInput, grainlaw.Error))
        self.assertFalse(issubclass(grainlaw.Interrupted, Exception))

    def test_what_progress_raises_stops_the_work_and_arrives(self):
        class Enough(Exception):
            pass

        def stop(fraction, text):
            raise Enough

        begin = time.monotonic()
        with self.assertRaises(Enough):
            grainlaw.calibrate(LONG, output="enough", progress=stop, **QUIET)
        self.assertLess(time.monotonic() - begin, 5)
        self.assertFalse(os.path.exists("enough/parameters.json"))

    def test_others_run_meanwhile(self):
        counted, stop = [0], threading.Event()

        def count():
            while not stop.is_set():
                counted[0] += 1
                time.sleep(0.001)

        thread = threading.Thread(target=count)
        thread.start()
        try:
            grainlaw.simulate(TEST | {"seed": 5}, "meanwhile", threads=1)
        finally:
            stop.set()
            thread.join()
        self.assertGreater(counted[0], 10)


class Interruption(unittest.TestCase):
    def script(self, body):
        return subprocess.Popen([sys.executable, "-c", textwrap.dedent(body)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def interrupted(self, process, ready, pause=0.3):
        """Seconds from the signal, `pause` after `ready` holds, to the end of the process."""
        for _ in range(600):
            if ready():
                break
            self.assertIsNone(process.poll(), process.stderr)
            time.sleep(0.1)
        time.sleep(pause)
        process.send_signal(signal.SIGINT)
        begin = time.monotonic()
        output = process.communicate(timeout=60)
        return time.monotonic() - begin, output

    def test_an_interrupt_stops_within_a_second_and_leaves_what_can_be_resumed(self):
        process = self.script(f"""
            import grainlaw, time
            try:
                grainlaw.calibrate({LONG!r}, output="out", threads=2)
            except grainlaw.Interrupted as error:
                print("interrupted", error, type(error.__cause__).__name__, flush=True)
        """)
        seconds, (out, err) = self.interrupted(process, lambda: len(finished("out")) >= 2)
        self.assertEqual(process.returncode, 0, err)
        self.assertRegex(out, "^interrupted .* KeyboardInterrupt$")
        print(f"figure python.interrupt.seconds {seconds:.3f}", flush=True)
        self.assertLess(seconds, 1.0 + 0.5, "one second to stop; the interpreter has to end, too")
        before = {file: os.stat(file).st_mtime_ns for file in finished("out")}
        self.assertEqual(len(before), 2)
        self.assertFalse(os.path.exists("out/parameters.json"))
        # what was begun goes on where it was
        self.assertTrue(list(pathlib.Path("out").rglob("*checkpoint*")), os.listdir("out/runs"))
        LONG["tests"][2]["segments"][0]["extent"]["eps_dev"] = 0.01
        try:
            grainlaw.calibrate(LONG, output="out", threads=2)
        except grainlaw.Error:
            pass  # 64 spheres at one density make no law
        for file, time_of in before.items():
            self.assertEqual(os.stat(file).st_mtime_ns, time_of, "a finished run was repeated")

    def test_a_batch_can_be_interrupted(self):
        calibrated("batched")
        process = self.script("""
            import grainlaw, numpy as np
            law = grainlaw.CalibratedLaw("batched")
            strain = np.zeros((1_200_000, 4, 6)) + np.arange(1, 5)[:, None] * [0.002, 0, -0.004, 0, 0, 0]
            open("begun", "w").close()
            law.predict_batch(strain, 0.74)
        """)
        seconds, (out, err) = self.interrupted(process, lambda: os.path.exists("begun"), pause=0.05)
        self.assertIn("grainlaw.Interrupted", err)
        self.assertLess(seconds, 2)


if __name__ == "__main__":
    unittest.main()
