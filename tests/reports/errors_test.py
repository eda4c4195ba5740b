"""reports/errors/measure with a fake program: its calls, calls that it does not repeat, and its output."""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

measure = pathlib.Path(sys.argv.pop()).resolve()

# Writes a list of its calls and returns the summary beside it; fails for scenes listed in fails.txt.
program = """#!/bin/sh
here=$(dirname "$0")
echo "$@" >> "$here/calls.txt"
name=$(basename "$2" .toml)
if grep -qx "$name" "$here/fails.txt"; then
  echo "made-up: progress" >&2
  echo "made-up: no answer" >&2
  exit 3
fi
while [ "$1" != --out ]; do shift; done
cp "$here/summary.json" "$2/summary.json"
"""

figures = {
    "force.nrmse": 0.25, "force.nrmse_uncertainty": 0.01,
    "force.peak_rel": -0.005, "force.peak_rel_uncertainty": 0.02,
    "force.rel_above_10pct_depth": 0.5, "force.rel_above_10pct_depth_uncertainty": "unknown",
    "force.torque_nrmse": 1e-17, "force.torque_nrmse_uncertainty": 0.01,
    "force.friction_nrmse": "undefined: the scene has no friction",
    "force.region1.nrmse": 0.125, "force.region1.nrmse_uncertainty": "unknown",
    "force.region1.peak_rel": None, "force.region1.peak_rel_uncertainty": "unknown",
    "shape.hausdorff_m": 0.002, "shape.hausdorff_m_uncertainty": 0.001,
    "shape.side_faces_rel_l2": "undefined: every face is touched",
    "contact.area_iou": 0.75,
}
before, after = "Before.\n\n", "\nAfter.\n"


class Measure(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "program").write_text(program)
        (self.folder / "program").chmod(0o755)
        (self.folder / "fails.txt").write_text("")
        (self.folder / "calls.txt").write_text("")
        self.page = self.folder / "page.md"
        self.page.write_text(before + "<!-- tables -->\nold\n<!-- end of tables -->\n" + after)
        self.answer(figures)

    def answer(self, summary):
        """As the program writes it: a missing number is null, and a text gives the reason."""
        reasons = {key: value for key, value in summary.items() if isinstance(value, str)}
        (self.folder / "summary.json").write_text(json.dumps(summary | dict.fromkeys(reasons) | {"reasons": reasons}))

    def tuned(self, study, formulation, text, law="duffing"):
        folder = self.folder / "tuned" / f"{study}-tune"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"parameters-{formulation}-{law}.toml").write_text(text)

    def run_on(self, *words):
        done = subprocess.run([measure, "--touchstone", self.folder / "program", "--store", self.folder / "store",
                               "--tuned", self.folder / "tuned", "--out", self.folder / "out", "--page", self.page,
                               *words], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return self.page.read_text()

    def calls(self):
        return (self.folder / "calls.txt").read_text().splitlines()

    def line(self, scene, preset, table):
        """The cells of a row after its scene and preset."""
        part = self.page.read_text().split(f"### {table}\n")[1].split("###")[0]
        rows = [row for row in part.splitlines() if row.startswith(f"| {scene} | {preset} |")]
        self.assertEqual(len(rows), 1, (scene, preset, table))
        return [cell.strip() for cell in rows[0].strip("|").split("|")][2:]

    def test_figures_stand_beside_their_uncertainty(self):
        page = self.run_on("hertz-sphere")
        self.assertTrue(page.startswith(before) and page.endswith(after) and "old" not in page)
        self.assertEqual(self.line("hertz-sphere", "untuned", "Force"),
                         ["25 % ± 1 %", "-0.5 % ± 2 %, not distinguishable", "50 % (uncertainty unknown)",
                          "0 % ± 1 %, not distinguishable"])
        surface = self.line("hertz-sphere", "untuned", "Surface and contact")
        self.assertEqual((surface[0], surface[-1]), ("2 mm ± 1 mm", "75 %"))
        self.assertEqual(self.line("hertz-sphere", "untuned", "Shape")[3], "–")
        self.assertEqual(self.line("hertz-sphere", "untuned", "Single regions"),
                         ["1", "12.5 % (uncertainty unknown)", "**not finite**"])

    def test_only_scenes_with_friction_have_friction(self):
        self.run_on("hertz-sphere")
        self.assertNotIn("| hertz-sphere", self.page.read_text().split("### Friction")[1].split("###")[0])
        self.answer(figures | {"force.friction_nrmse": 0.5, "force.slip_onset_error_m": -0.0012,
                               "force.slip_onset_error_m_uncertainty": 0.0005, "force.slip_onset_fast_m": 0.005})
        self.run_on("ball-on-cube-slide")
        cells = self.line("ball-on-cube-slide", "untuned", "Friction")
        self.assertEqual((cells[0], cells[2], cells[3]), ("50 % (uncertainty unknown)", "-1.2 mm ± 0.5 mm", "5 mm"))

    def test_presets_are_the_studies_values(self):
        text = "[contact]\nlaw = \"duffing\"\nk1_n_per_m = 123.5\n[contact.friction]\nK = 2.0\n[fast]\nC_n = 0.25\n"
        self.tuned("friction", "published", text)
        self.tuned("ball-on-cube", "published", text)
        self.run_on("ball-on-cube-slide", "ball-on-cube-press", "--", "--minutes", "7")
        slide, press = ([call for call in self.calls() if f"{name}.toml" in call] for name in
                        ("ball-on-cube-slide", "ball-on-cube-press"))
        self.assertEqual((len(slide), len(press)), (3, 3))
        self.assertIn("--set fast.formulation=response", slide[2])
        self.assertIn("--set fast.formulation=published", slide[0])
        self.assertNotIn("k1_n_per_m", slide[0])
        # For the fast model alone: --set would give the tuned friction to the reference as well.
        for call, study in ((slide[1], "friction"), (press[1], "ball-on-cube")):  # without the response model
            self.assertRegex(call, rf"--parameters \S*{study}-tune/parameters-published-duffing.toml")
            self.assertNotIn("--set", call)
        self.assertTrue(all(call.endswith("--minutes 7") for call in slide + press))

    def test_the_law_is_the_scenes_own(self):
        self.tuned("mallet", "published", "[contact]\nlaw = \"duffing\"\nk1_n_per_m = 123.5\n")
        self.run_on("mallet-head-on-cube")
        self.assertIn("not tuned yet", self.line("mallet-head-on-cube", "tuned published", "Force")[0])
        self.tuned("mallet", "published", "[contact]\nk1_per_radius_n_per_m2 = 456.5\n", "area_aware")
        self.run_on("--preset", "tuned published", "mallet-head-on-cube")
        self.assertIn("mallet-tune/parameters-published-area_aware.toml", self.calls()[-1])

    def test_a_reason_names_no_place_of_this_machine(self):
        (self.folder / "program").write_text("#!/bin/sh\necho \"$2:1:1: made-up\" >&2\nexit 3\n")
        self.run_on("hertz-sphere")
        self.assertEqual(self.line("hertz-sphere", "all", "Force")[0], "meshes/scenes/hertz-sphere.toml:1:1: made-up")

    def test_what_is_missing_says_so(self):
        self.run_on("hertz-sphere")
        self.assertIn("touchstone tune meshes/studies/ball-on-cube.toml",
                      self.line("hertz-sphere", "tuned corrected", "Force")[0])
        self.assertEqual(self.line("pin-on-cylinder", "all", "Shape")[0], "not measured yet")

    def test_a_scene_without_an_answer_keeps_its_row_and_is_asked_once(self):
        self.tuned("ball-on-cube", "published", "[fast]\nC_n = 0.25\n")
        (self.folder / "fails.txt").write_text("compass-two-pins\n")
        self.run_on("compass-two-pins")
        self.assertEqual(self.line("compass-two-pins", "all", "Force")[0], "made-up: no answer")
        self.assertEqual(len(self.calls()), 1)
        # A failed run does not count as done.
        (self.folder / "fails.txt").write_text("")
        self.run_on("compass-two-pins")
        self.assertEqual(self.line("compass-two-pins", "untuned", "Force")[0], "25 % ± 1 %")

    def test_goes_on_where_it_ended(self):
        self.tuned("ball-on-cube", "published", "[fast]\nC_n = 0.25\n")
        self.run_on("hertz-sphere")
        self.run_on("hertz-sphere")
        self.assertEqual(len(self.calls()), 3)
        self.tuned("ball-on-cube", "published", "[fast]\nC_n = 0.5\n")
        self.run_on("hertz-sphere")
        self.assertEqual(len(self.calls()), 4)
        (self.folder / "out/hertz-sphere/untuned/summary.json").unlink()
        self.run_on("hertz-sphere")
        self.assertEqual(len(self.calls()), 5)

    def test_rows_stay_where_nothing_is_measured_again(self):
        self.run_on("compass-two-pins", "ball-on-cube-slide")
        shutil.rmtree(self.folder / "out")
        self.answer(figures | {"force.nrmse": 0.5})
        self.run_on("--preset", "response", "compass-two-pins")
        self.assertEqual(self.line("compass-two-pins", "response", "Force")[0], "50 % ± 1 %")
        self.assertEqual(self.line("compass-two-pins", "untuned", "Force")[0], "25 % ± 1 %")
        self.assertEqual(self.line("compass-two-pins", "untuned", "Single regions")[0], "1")
        self.assertEqual(self.line("ball-on-cube-slide", "response", "Surface and contact")[0], "2 mm ± 1 mm")

    def test_only_reading_asks_nobody(self):
        self.run_on("hertz-sphere")
        self.answer(figures | {"force.nrmse": 0.5})
        calls = self.calls()
        self.run_on("--only-read")
        self.assertEqual(self.calls(), calls)
        self.assertEqual(self.line("hertz-sphere", "untuned", "Force")[0], "25 % ± 1 %")

    def test_every_shipped_scene_has_a_study_that_exists(self):
        page = self.run_on("--only-read").split("### Whose parameters")[1].split("###")[0]
        self.assertIn("| ball-on-cube-slide | friction | another track |", page)
        self.assertIn("| ball-on-cube-press | ball-on-cube | whole track |", page)
        root = measure.parents[2]
        for scene in (root / "meshes/scenes").glob("*.toml"):
            row = next(row for row in page.splitlines() if row.startswith(f"| {scene.stem} |"))
            self.assertTrue((root / "meshes/studies" / f"{row.split('|')[2].strip()}.toml").exists(), row)


if __name__ == "__main__":
    unittest.main()
