"""Result files read by Python's csv and json: every column of numbers contains numbers, even if a value is unknown.

    results_test.py TOUCHSTONE ROOT
"""
import csv
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

touchstone = sys.argv.pop(1)
root = pathlib.Path(sys.argv.pop(1)).resolve()

# Few points and instants of an axisymmetric scene: a reference in a second.
quick = ["--set", "fast.triangles=300", "--set", "compare.instants=4"]
texts = {"reference.model", "reference.why_ended", "fast.status"}


def run(*arguments, code=0):
    done = subprocess.run([touchstone, *map(str, arguments)], text=True, capture_output=True)
    if done.returncode != code:
        raise AssertionError(f"{arguments} ended with {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def refuse_constant(name):
    raise AssertionError(f"{name} is no JSON")


def read_json(file):
    return json.loads(file.read_text(), parse_constant=refuse_constant)


def read_columns(file):
    with open(file, newline="") as stream:
        rows = list(csv.reader(stream))
    for row in rows[1:]:
        if len(row) != len(rows[0]):
            raise AssertionError(f"{file}: a row of {len(row)} cells under {len(rows[0])} heads")
    return {name: [float(row[i]) for row in rows[1:]] for i, name in enumerate(rows[0])}


class Results(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.out = pathlib.Path(cls.holder.name)
        scene = root / "meshes/scenes/sphere-on-sphere-body.toml"
        store = ["--store", cls.out / "store"]
        run("fast", scene, "--quiet", "--out", cls.out / "fast", *quick)
        for level, name in ((3, "known"), (1, "unknown")):
            asked = [scene, "--quiet", "--level", level, *store, *quick]
            run("reference", *asked, "--out", cls.out / f"reference-{name}")
            run("compare", *asked, "--out", cls.out / f"compare-{name}")

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    def folders(self):
        names = ["fast"] + [f"{verb}-{name}" for verb in ("reference", "compare") for name in ("known", "unknown")]
        return [self.out / name for name in names]

    def test_every_column_is_numbers_and_none_is_infinite(self):
        for folder in self.folders():
            columns = read_columns(folder / "curve.csv")
            self.assertIn("depth_m", columns)
            for name, values in columns.items():
                self.assertEqual(len(values), 4, (folder, name))
                for value in values:
                    self.assertLess(abs(value) if math.isfinite(value) else 0.0, 1e100, (folder, name))
                    self.assertFalse(math.isinf(value), (folder, name))

    def test_an_unknown_uncertainty_is_nan_and_a_known_one_a_number(self):
        for verb, prefix in (("reference", ""), ("compare", "reference_")):
            name = prefix + "force_uncertainty_n"
            self.assertTrue(all(map(math.isnan, read_columns(self.out / f"{verb}-unknown/curve.csv")[name])))
            self.assertTrue(all(map(math.isfinite, read_columns(self.out / f"{verb}-known/curve.csv")[name])))

    def test_a_key_of_the_summary_is_a_number_or_null_or_always_a_text(self):
        for folder in self.folders():
            summary = read_json(folder / "summary.json")
            units, reasons = summary.pop("units"), summary.pop("reasons", {})
            self.assertEqual(units.keys(), summary.keys())
            for key, value in summary.items():
                if key in texts:
                    self.assertIsInstance(value, str, (folder, key))
                elif value is not None:
                    self.assertIsInstance(value, (int, float), (folder, key))
            self.assertEqual({key for key, value in summary.items() if value is None}, set(reasons), folder)

    def test_the_summary_says_what_is_unknown(self):
        for key in ("force.nrmse_uncertainty", "shape.rel_l2_uncertainty", "reference.force_uncertainty_rel"):
            known, unknown = (read_json(self.out / f"compare-{name}/summary.json") for name in ("known", "unknown"))
            self.assertGreater(known[key], 0.0)
            self.assertIsNone(unknown[key])
            self.assertEqual(unknown["reasons"][key], "unknown")

    def test_people_read_unknown_and_never_nan(self):
        words = run("reference", root / "meshes/scenes/sphere-on-sphere-body.toml", "--quiet", "--level", 1, "--store",
                    self.out / "store", *quick, "--out", self.out / "again")
        self.assertIn(", uncertainty unknown", words)
        for word in words.lower().split():
            self.assertNotIn(word.strip("().,;:-+"), ("nan", "inf"))

    def test_both_series_name_a_file_for_every_instant(self):
        for folder in self.folders():
            times = read_columns(folder / "curve.csv")["time_s"]
            for name in ("surface", "tool"):
                collection = xml.etree.ElementTree.parse(folder / f"{name}.pvd").getroot()
                rows = collection.findall("Collection/DataSet")
                self.assertEqual([float(row.get("timestep")) for row in rows], times)
                for row in rows:
                    xml.etree.ElementTree.parse(folder / row.get("file"))

    def test_the_table_of_a_study_is_numbers(self):
        study = self.out / "study.toml"
        study.write_text(f'scene = "{root}/meshes/scenes/sphere-on-sphere-body.toml"\nrun = "compare"\n'
                         "[set]\nfast.triangles = 300\ncompare.instants = 4\n"
                         '[[axis]]\nkey = "reference.levels"\nvalues = [1, 3]\n')
        folder = self.out / "study"
        run("study", "expand", study, "--out", folder, "--store", self.out / "store")
        run("study", "run", folder, "--quiet", "--store", self.out / "store")
        run("study", "collect", folder)
        with open(folder / "summary.csv", newline="") as stream:
            rows = list(csv.DictReader(stream))
        self.assertTrue(math.isnan(float(rows[0]["force.nrmse_uncertainty"])))
        self.assertTrue(math.isfinite(float(rows[1]["force.nrmse_uncertainty"])))
        cases = read_json(folder / "summary.json")["cases"]
        self.assertIsNone(cases[0]["figures"]["force.nrmse_uncertainty"])
        # The page belongs to the study and moves with it.
        moved = self.out / "elsewhere"
        shutil.move(folder, moved)
        page = (moved / "report.html").read_text()
        xml.etree.ElementTree.fromstring(page.replace("<!DOCTYPE html>", ""))
        for case in cases:
            self.assertIn(case["name"] + "</a>", page)
            self.assertTrue((moved / f"results/{case['id']}/report.html").exists())
            self.assertIn(f"href=\"results/{case['id']}/report.html\"", page)
        self.assertIn("± unknown", page)
        self.assertNotIn(str(self.out), page)

    def test_a_study_with_a_mesh_tool_can_be_moved_before_and_after_it_is_run(self):
        inputs, folder, moved, away = (self.out / name for name in ("inputs", "mallets", "moved", "away"))
        for name in ("scenes/mallet-head-on-cube.toml", "tools/mallet.stl"):
            (inputs / name).parent.mkdir(parents=True)
            shutil.copy(root / "meshes" / name, inputs / name)
        study = inputs / "study.toml"
        study.write_text('scene = "scenes/mallet-head-on-cube.toml"\nrun = "fast"\n'
                         "[set]\nfast.triangles = 300\ncompare.instants = 3\n"
                         '[[axis]]\nkey = "fast.C_n"\nvalues = [0.1, 0.2]\n')
        run("study", "expand", study, "--out", folder)
        shutil.rmtree(inputs)
        shutil.move(folder, moved)
        run("study", "run", moved, "--quiet")
        run("study", "collect", moved)
        case = read_json(moved / "summary.json")["cases"][0]
        shutil.move(moved / f"results/{case['id']}", away)
        shutil.rmtree(moved)
        self.assertEqual((away / "tool.stl").read_bytes(), (root / "meshes/tools/mallet.stl").read_bytes())
        picture = self.out / "picture.jpg"
        run("view", away, "--screenshot", picture)
        self.assertEqual(picture.read_bytes()[:3], b"\xff\xd8\xff")


if __name__ == "__main__":
    unittest.main()
