"""reports/tuning/measure with a fake program: the tables of a study with results, and of one without."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

measure = pathlib.Path(sys.argv.pop()).resolve()

# Has results for one study only.
program = """#!/bin/sh
if [ "$(basename "$2" .toml)" != mallet ]; then
  echo "made-up: no answer" >&2
  exit 3
fi
here=$(dirname "$0")
while [ "$1" != --out ]; do shift; done
cp "$here/summary.json" "$2/summary.json"
"""
summary = {
    "held_out.head.reference.force_uncertainty_rel": 0.0125,
    "training.tail.reference.force_uncertainty_rel": 0.005,
    "corrected-area_aware.held_out.head.force.nrmse": 0.25,
    "corrected-area_aware.held_out.head.shape.rel_l2": 0.5,
    "corrected-area_aware.held_out.head.shape.rel_l2_uncertainty": 0.75,
    "corrected-area_aware.training.shape_parts.whole": 0.4,
    "corrected-area_aware.training.shape_parts.without_local_factor": 0.6,
    "corrected-area_aware.training.shape_parts.anchors_at_rest": 0.7,
    "corrected-area_aware.training.shape_parts.hat_alone": 0.9,
    "corrected-area_aware.training.tail.force.nrmse": 0.125,
    "corrected-area_aware.training.tail.shape.rel_l2": "unknown",
    "corrected-area_aware.training.tail-to-1-5-mm.force.nrmse": 0.75,
    "corrected-area_aware.training.tail.force.friction_nrmse": "undefined: the scene has no friction",
}


class Measure(unittest.TestCase):
    def setUp(self):
        self.kept = tempfile.TemporaryDirectory()
        folder = pathlib.Path(self.kept.name)
        (folder / "touchstone").write_text(program)
        (folder / "touchstone").chmod(0o755)
        (folder / "summary.json").write_text(json.dumps(summary))
        self.page = folder / "page.md"
        self.page.write_text("Before.\n<!-- tables -->\nold\n<!-- end of tables -->\nAfter.\n")
        self.command = [measure, "--touchstone", folder / "touchstone", "--out", folder / "out", "--page", self.page]

    def tearDown(self):
        self.kept.cleanup()

    def run_it(self, *arguments):
        return subprocess.run([*map(str, self.command), *arguments], capture_output=True, text=True)

    def test_a_row_per_model_and_contact_with_the_figures_there_are(self):
        self.assertEqual(self.run_it("mallet", "friction").returncode, 0)
        text = self.page.read_text()
        self.assertIn("| model | contact | force, of the peak | shape |\n", text)
        self.assertIn("| corrected, area-aware | held out: head | 25 % | 50 % |\n", text)
        self.assertIn("| corrected, area-aware | training: tail | 12.5 % | – |\n", text)
        self.assertIn("| corrected, area-aware | training: tail, to 1.5 mm | 75 % | – |\n", text)
        self.assertIn("| corrected, area-aware | 90 % | 60 % | 70 % | 40 % |\n", text)
        self.assertIn("known to 1.25 % or better", text)

    def test_a_study_without_answer_says_why_or_that_it_was_not_asked(self):
        self.run_it("mallet", "friction")
        text = self.page.read_text()
        self.assertIn("No answer: made-up: no answer", text)
        self.assertIn("Not measured yet.", text)

    def test_only_what_stands_between_the_marks_changes(self):
        self.run_it("--only-read")
        text = self.page.read_text()
        self.assertTrue(text.startswith("Before.\n<!-- tables -->\n"))
        self.assertTrue(text.endswith("<!-- end of tables -->\nAfter.\n"))
        self.assertNotIn("old", text)
        self.page.write_text("no marks\n")
        refused = self.run_it("--only-read")
        self.assertNotEqual(refused.returncode, 0)
        self.assertEqual(self.page.read_text(), "no marks\n")

    def test_a_name_that_is_no_study_is_refused(self):
        refused = self.run_it("hammer")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("no study hammer", refused.stderr)


unittest.main()
