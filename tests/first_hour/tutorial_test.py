"""Runs the commands of reports/first-scene.md in an empty folder and checks the results.

    tutorial_test.py ROOT BUILD_DIR
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

root, build = (pathlib.Path(argument) for argument in sys.argv[1:3])
del sys.argv[1:3]


class Tutorial(unittest.TestCase):
    def test_every_command_works_as_typed(self):
        commands = re.findall(r"^```sh\n(.*?)^```", (root / "reports" / "first-scene.md").read_text(), re.M | re.S)
        self.assertGreater(len(commands), 8)
        with tempfile.TemporaryDirectory() as folder:
            home = pathlib.Path(folder)
            # The repository where the page expects it, with the binaries under test.
            (home / "touchstone" / "build").mkdir(parents=True)
            (home / "touchstone" / "meshes").symlink_to(root / "meshes")
            (home / "touchstone" / "build" / "release").symlink_to(build)
            answer = subprocess.run(["bash", "-e"], input="".join(commands), cwd=home, text=True, capture_output=True,
                                    env={**os.environ, "HOME": folder})
            self.assertEqual(answer.returncode, 0, answer.stdout[-4000:] + answer.stderr[-4000:])

            project = home / "my-project"
            first = json.loads((project / "out/compare/summary.json").read_text())
            tuned = json.loads((project / "out/compare-tuned/summary.json").read_text())
            self.assertLess(first["force.nrmse_uncertainty"], 0.05)
            self.assertLess(tuned["force.nrmse"], first["force.nrmse"], "tuning makes the force better")
            for name in ("out/fast/report.html", "out/compare/report.html", "out/compare.png", "out/tuned/report.html",
                         "gates/reference/press/reference.json"):
                self.assertTrue((project / name).exists(), name)
            self.assertIn("press.force", answer.stdout)

    def test_files_that_the_page_links_exist(self):
        page = root / "reports" / "first-scene.md"
        for link in re.findall(r"\]\(([^)#:]+)\)", page.read_text()):
            self.assertTrue((page.parent / link).exists(), link)


unittest.main()
