"""Series as arrays: the CSV's names and numbers, views into the rows and not copies, read-only, alive as long as they are used."""

import csv
import gc
import unittest

import numpy as np

import grainlaw
from scene import STARTERS

NAME = "D2-0.71-s1"


def csv_columns():
    with open(STARTERS / f"{NAME}.csv", newline="") as text:
        rows = list(csv.reader(text))
    return {name: [float(v) if v else np.nan for v in values] for name, values in zip(rows[0], zip(*rows[1:]))}


class SeriesTest(unittest.TestCase):
    def setUp(self):
        self.dataset = grainlaw.Dataset(STARTERS)
        self.series = self.dataset[NAME].series

    def test_names_units_and_numbers_are_those_of_the_file(self):
        for title, values in csv_columns().items():
            name, _, unit = title.partition("[")
            np.testing.assert_array_equal(self.series[name], values, title)
            np.testing.assert_array_equal(getattr(self.series, name), values, title)
            self.assertEqual(self.series.units[name], unit.rstrip("]"))
            self.assertIn(name, self.series)
            self.assertIn(name, dir(self.series))
        self.assertEqual(set(dict(self.series)), set(self.series.keys()))
        self.assertEqual(len(self.series), len(self.series.keys()))
        self.assertEqual(self.series.segment.dtype, np.int32)

    def test_a_column_is_a_view(self):
        one, other = self.series.P_star, self.series["P_star"]
        self.assertTrue(np.shares_memory(one, other))
        stress = self.series.stress
        self.assertEqual(stress.shape, (self.series.rows, 3, 3))
        for i, row in enumerate("xyz"):
            for j, column in enumerate("xyz"):
                name = "stress_" + "".join(sorted((row, column)))
                np.testing.assert_array_equal(stress[:, i, j], self.series[name])
        self.assertTrue(np.shares_memory(stress, self.series.stress_zz))
        distance = self.series.E_pot.__array_interface__["data"][0] - self.series.P_star.__array_interface__["data"][0]
        self.assertLess(abs(distance), self.series.P_star.strides[0], "in one row")

    def test_nobody_can_write(self):
        column = self.series.nu
        with self.assertRaises(ValueError):
            column[0] = 1
        with self.assertRaises(ValueError):
            column.flags.writeable = True
        for name in self.series:
            self.assertFalse(self.series[name].flags.writeable, name)

    def test_arrays_keep_what_they_look_at(self):
        column = self.series.nu
        expected = np.array(csv_columns()["nu"])
        del self.series, self.dataset
        gc.collect()
        ballast = [np.full(10**5, np.pi) for _ in range(50)]  # would be written where the rows were
        np.testing.assert_array_equal(column, expected)
        del ballast

    def test_what_is_not_there(self):
        for name in ("P", "stress_", "stress_xxx", "stress_zy", "P_star[Pa]", ""):
            with self.assertRaises(KeyError):
                self.series[name]
            self.assertNotIn(name, self.series)
        with self.assertRaises(AttributeError):
            self.series.pressure
        self.assertFalse(hasattr(self.series, "__array_interface__"))
        with self.assertRaises(KeyError):
            self.dataset["none"]

    def test_the_data_set(self):
        self.assertEqual(len(self.dataset), 15)
        self.assertEqual(self.dataset.seeds, [1, 2, 3])
        test = self.dataset[NAME]
        self.assertEqual((test.name, test.role, test.packing["seed"]), (NAME, "calibration", 1))
        self.assertEqual(grainlaw.Path(test.path).nu, test.path["initial"]["nu"])
        self.assertIn(NAME, self.dataset)
        self.assertEqual([name for name in self.dataset if name.startswith("ISO")],
                         [f"ISO-unloading-s{seed}" for seed in (1, 2, 3)])


if __name__ == "__main__":
    unittest.main()
