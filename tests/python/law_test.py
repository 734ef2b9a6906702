"""The calibrated law in Python: parameters, predictions in memory beside those in files, batches beside single paths."""

import copy
import csv
import json
import os
import pickle
import subprocess
import threading
import unittest

import numpy as np

import grainlaw
from scene import TURN, UNI, calibrated, part_of_the_papers_data


def columns_of(file):
    with open(file, newline="") as text:
        rows = list(csv.reader(text))
    return {name.split("[")[0]: [float(v) if v else np.nan for v in values] for name, values in zip(rows[0], zip(*rows[1:]))}


def setUpModule():
    global calibration, law
    calibration = calibrated(dataset=part_of_the_papers_data())
    law = calibration.law


class Parameters(unittest.TestCase):
    def test_they_are_those_of_the_file(self):
        with open("law/parameters.json") as text:
            document = json.load(text)
        self.assertEqual(list(law.parameters), list(document["parameters"]))
        for name, entry in document["parameters"].items():
            parameter = law[name]
            for key in ("value", "standard_error", "status", "symbol", "equation"):
                self.assertEqual(getattr(parameter, key), entry[key], (name, key))
            self.assertEqual(parameter.interval, tuple(entry["interval_95"]) if "interval_95" in entry else None)
        names = list(law.parameters)
        index = [names.index(name) for name in document["covariance"]["names"]]
        np.testing.assert_array_equal(law.covariance[np.ix_(index, index)], document["covariance"]["matrix"])
        for key, limits in document["ranges"].items():
            self.assertEqual(law.range[key], tuple(limits))

    def test_errors_are_the_square_roots_of_the_covariance(self):
        for i, parameter in enumerate(law.parameters.values()):
            if parameter.status == "fitted" and parameter.standard_error:
                self.assertAlmostEqual(np.sqrt(law.covariance[i, i]) / parameter.standard_error, 1, 12)

    def test_a_file_read_again_is_the_same_law(self):
        for source in ("law", b"law", "law/parameters.json"):
            again = grainlaw.CalibratedLaw(source)
            self.assertEqual([p.value for p in again.parameters.values()], [p.value for p in law.parameters.values()])

    def test_other_processes_get_the_same_law(self):
        for sent in (law, law.with_values({"pressure.p0": 0.04}), grainlaw.CalibratedLaw("law")):
            for got in (pickle.loads(pickle.dumps(sent)), copy.deepcopy(sent)):
                np.testing.assert_array_equal(got.covariance, sent.covariance)
                self.assertEqual((got.file, got.models, got.bands, got.range, got.dataset_digest, got.converged, repr(got)),
                                 (sent.file, sent.models, sent.bands, sent.range, sent.dataset_digest, sent.converged, repr(sent)))
                for name, parameter in sent.parameters.items():
                    for key in ("value", "standard_error", "degrees_of_freedom", "interval", "status", "note"):
                        self.assertEqual(getattr(got[name], key), getattr(parameter, key), (name, key))
                path = pickle.loads(pickle.dumps(grainlaw.Path(TURN)))
                ours, theirs = sent.predict(TURN, bands=True), got.predict(path, bands=True)
                for column in ours:
                    np.testing.assert_array_equal(theirs[column], ours[column], column)

    def test_changed_values(self):
        p0 = law["pressure.p0"].value
        changed = law.with_values({"pressure.p0": 2 * p0})
        self.assertEqual((law["pressure.p0"].value, changed["pressure.p0"].value), (p0, 2 * p0))
        self.assertIsNone(changed["pressure.p0"].standard_error)
        i = list(law.parameters).index("pressure.p0")
        self.assertFalse(changed.covariance[i].any() or changed.covariance[:, i].any())
        # Eq. (14): P is proportional to p0, in the reduced law along the whole path
        np.testing.assert_allclose(changed.predict(UNI, "reduced").P_star, 2 * law.predict(UNI, "reduced").P_star, rtol=1e-14)
        changed.save("changed.json")
        np.testing.assert_array_equal(grainlaw.CalibratedLaw("changed.json").predict(UNI).P_star, changed.predict(UNI).P_star)
        with self.assertRaisesRegex(grainlaw.InvalidInput, "save"):
            grainlaw.predict(changed, UNI, "nowhere")
        self.assertFalse(os.path.exists("nowhere"))


class Predictions(unittest.TestCase):
    def test_memory_files_and_program_agree_to_the_bit(self):
        for name, path in (("uni", UNI), ("turn", TURN)):
            with open(f"{name}.json", "w") as text:
                json.dump(path, text)
            folder = grainlaw.predict(law, path, f"by_python/{name}")
            self.assertEqual([curve.model for curve in folder.curves], law.models)
            subprocess.run([os.environ["GRAINLAW"], "predict", "law/parameters.json", f"{name}.json", "-o", f"by_program/{name}",
                            "--quiet"], check=True, stdout=subprocess.DEVNULL)
            for curve in folder.curves:
                file = f"{name}/{curve.model}-law.csv"
                of_program = columns_of("by_program/" + file)
                self.assertEqual(list(curve), list(of_program))
                with open("by_program/" + file) as one, open("by_python/" + file) as other:
                    self.assertEqual(one.read(), other.read())
                in_memory = law.predict(f"{name}.json", curve.model, bands=True)
                for column, values in of_program.items():
                    np.testing.assert_array_equal(curve[column], values, column)
                    np.testing.assert_array_equal(in_memory[column], values, column)
                plain = law.predict(grainlaw.Path(path), curve.model)
                np.testing.assert_allclose(plain.P_star, in_memory.P_star, rtol=1e-6)  # sensitivities choose other steps
                self.assertTrue(np.isnan(plain.P_star_mean95).all())
            again = grainlaw.PredictionFolder(f"by_python/{name}")
            np.testing.assert_array_equal(again.curves[0].s_par, folder.curves[0].s_par)
            self.assertEqual(again.recommended, folder.recommended)

    def test_at_the_rows_of_a_test(self):
        test = calibration.dataset["D2-0.74-s2"]
        for start in ("law", "measured"):
            curve = law.predict(test, "evolution", start=start)
            self.assertEqual((curve.seed, curve.start, curve.rows), (2, start, test.series.rows))
            np.testing.assert_allclose(curve.eps_dev, test.series.eps_dev, atol=1e-9)
        self.assertEqual(curve.P_star[0], test.series.P_star[0])
        with self.assertRaisesRegex(grainlaw.InvalidInput, "Test"):
            law.predict(UNI, start="measured")
        with self.assertRaisesRegex(grainlaw.InvalidInput, "points: a Test is predicted at its own rows"):
            law.predict(test, points=50)
        self.assertEqual(len(law.predict(UNI, points=None)), len(law.predict(UNI)))
        self.assertEqual(law.predict(UNI, points=50).rows, 51)

    def test_the_law_may_decide_the_strain(self):
        drained = {"initial": {"nu": 0.74}, "segments": [
            {"rate_tensor": [[0, 0, 0], [0, 0, 0], [0, 0, -1]], "extent": {"eps_dev": 0.03},
             "free": {"xx": {"quantity": "stress"}, "yy": {"quantity": "stress"}}}]}
        curve = law.predict(drained, "evolution", points=50)
        lateral = curve.P_star + curve.sigma_dev_xx
        np.testing.assert_allclose(lateral, lateral[0], rtol=1e-6)
        self.assertGreater(np.ptp(curve.eps_vol), 0)

    def test_many_threads_may_use_one_law(self):
        expected, found = law.predict(TURN).P_star, []
        work = lambda: found.extend(np.array_equal(law.predict(TURN).P_star, expected) for _ in range(50))
        threads = [threading.Thread(target=work) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(found, [True] * 200)


class Paths(unittest.TestCase):
    def test_a_copy_says_the_same(self):
        path = grainlaw.Path(UNI | {"seeds": [901], "rows": 5})
        for other in (pickle.loads(pickle.dumps(path)), copy.deepcopy(path), grainlaw.Path(path.to_dict())):
            self.assertEqual(other.to_dict(), path.to_dict())
        self.assertEqual((path.to_dict()["seeds"], path.to_dict()["rows"]), ([901], 5))

    def test_what_the_law_does_not_know_of_it_is_said(self):
        loading = law.predict({**UNI, "initial": {"nu": 0.70, "branch": "loading"}})
        self.assertTrue(any("initial.branch" in warning for warning in loading.warnings), loading.warnings)

    def test_values_by_hand_have_no_data_behind_them(self):
        self.assertNotEqual(law.dataset_digest, "")
        self.assertEqual(law.with_values({"pressure.p0": 0.04}).dataset_digest, "")


class Batches(unittest.TestCase):
    def histories(self, paths, steps, scale):
        random = np.random.default_rng(7)
        steps = scale * random.normal(size=(paths, steps, 6)) * [1, 1, 1, 0.5, 0.5, 0.5]
        return np.cumsum(steps, axis=1), random.uniform(0.68, 0.76, paths)

    def test_each_path_is_that_of_a_single_prediction(self):
        strain, nu = self.histories(60, 4, 0.015)
        for model in law.models:
            batch = law.predict_batch(strain, nu, model, accuracy=1e-10)
            unjammed = 0
            for i in range(len(nu)):
                steps = np.diff(strain[i], axis=0, prepend=np.zeros((1, 6)))
                segments = []
                for step in steps:
                    xx, yy, zz, yz, xz, xy = step
                    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
                    deviator = tensor - np.trace(tensor) / 3 * np.eye(3)
                    segments.append({"rate_tensor": tensor, "extent": {"eps_dev": np.sqrt(1.5 * (deviator**2).sum())}})
                single = law.predict({"initial": {"nu": nu[i]}, "segments": segments}, model, points=1)
                scale = max(single.P_star.max(), 1e-3)
                np.testing.assert_allclose(batch.P_star[i], single.P_star[1::2], atol=1e-5 * scale, err_msg=f"{model} {i}")
                for k, c in enumerate(("xx", "yy", "zz", "yz", "xz", "xy")):
                    np.testing.assert_allclose(batch.sigma_dev[i, :, k], single[f"sigma_dev_{c}"][1::2], atol=1e-5 * scale)
                    np.testing.assert_allclose(batch.fabric_dev[i, :, k], single[f"fabric_dev_{c}"][1::2], atol=1e-4)
                unjammed += single.unjammed
            self.assertGreater(unjammed, 3, "no path near unjamming was tried")

    def test_threads_layout_and_type_change_nothing(self):
        strain, nu = self.histories(40, 3, 0.003)
        expected = law.predict_batch(strain, nu, threads=1).P_star
        fortran = np.asfortranarray(strain)
        for other in (fortran, fortran[::-1][::-1], strain.astype(">f8"), strain.tolist()):
            np.testing.assert_array_equal(law.predict_batch(other, nu, threads=3).P_star, expected)
        np.testing.assert_array_equal(law.predict_batch(strain, np.full(40, 0.74)).P_star, law.predict_batch(strain, 0.74).P_star)

    def test_more_steps_of_one_direction_change_nothing(self):
        whole = np.array([[[0, 0, -0.13, 0, 0, 0]]])
        for model in law.models:
            once = law.predict_batch(whole, 0.70, model, accuracy=1e-10)
            often = law.predict_batch(whole * np.linspace(0.02, 1, 50)[:, None], 0.70, model, accuracy=1e-10)
            for name in ("P_star", "sigma_dev", "fabric_dev"):
                np.testing.assert_allclose(getattr(often, name)[0, -1], getattr(once, name)[0, -1], rtol=1e-6, atol=1e-8)

    def test_scalars_of_numpy_and_what_has_a_method_mask(self):
        class Column(list):  # as pandas' have
            def mask(self):
                return self

        strain, nu = self.histories(2, 2, 0.003)
        expected = law.predict_batch(strain, [0.74, 0.74]).P_star
        for given in (np.float64(0.74), np.array(0.74), Column([0.74, 0.74])):
            np.testing.assert_array_equal(law.predict_batch(strain, given).P_star, expected)

    def test_steps_without_strain_change_nothing(self):
        strain, nu = self.histories(5, 2, 0.003)
        batch = law.predict_batch(np.repeat(strain, 2, axis=1), nu)
        np.testing.assert_array_equal(batch.P_star[:, ::2], batch.P_star[:, 1::2])
        at_rest = law.predict_batch(np.zeros((1, 3, 6)), [0.74])
        np.testing.assert_array_equal(at_rest.P_star, law.predict(UNI | {"initial": {"nu": 0.74}}).P_star[0])
        self.assertEqual(law.predict_batch(np.empty((0, 3, 6)), []).P_star.shape, (0, 3))


if __name__ == "__main__":
    unittest.main()
