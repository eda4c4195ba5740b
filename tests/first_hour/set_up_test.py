"""Set-up for a new user: the package lists, and the scripts' messages on another system.

    set_up_test.py ROOT
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

root = pathlib.Path(sys.argv.pop(1))


def packages(name):
    lines = (root / ".ci" / name).read_text().splitlines()
    return [line for line in lines if not line.startswith("#")]


def require_machine(os_release):
    """The message of ./demo on a machine with this os-release."""
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "os-release"
        file.write_text(os_release)
        return subprocess.run(["bash", "-c", f'. .ci/setup.sh; require_machine "{file}"'], cwd=root, text=True,
                              capture_output=True)


class SetUp(unittest.TestCase):
    def test_a_package_is_named_once(self):
        names = packages("packages") + packages("packages-tests")
        self.assertEqual(len(names), len(set(names)))

    def test_the_demo_installs_nothing_that_only_tests_need(self):
        demo = (root / "demo").read_text()
        self.assertNotIn("packages-tests", demo)
        self.assertIn("-DTOUCHSTONE_TESTS=OFF", demo)
        for name in ("libgtest-dev", "valgrind", "chromium", "calculix-ccx"):
            self.assertIn(name, packages("packages-tests"))
        self.assertIn("packages-tests", (root / "check").read_text())

    def test_debian_12_is_taken(self):
        self.assertEqual(require_machine('ID=debian\nVERSION_ID="12"\n').returncode, 0)

    def test_another_system_is_told_of_the_container(self):
        answer = require_machine('ID=fedora\nVERSION_ID=41\nPRETTY_NAME="Fedora Linux 41"\n')
        self.assertEqual(answer.returncode, 1)
        self.assertIn("Fedora Linux 41", answer.stderr)
        self.assertIn("docker build -f Containerfile", answer.stderr)
        self.assertTrue((root / "Containerfile").exists())

    def test_ubuntu_is_told_what_is_missing(self):
        jammy = require_machine('ID=ubuntu\nVERSION_ID="22.04"\nPRETTY_NAME="Ubuntu 22.04.4 LTS"\n')
        self.assertIn("libtomlplusplus-dev", jammy.stderr)
        noble = require_machine('ID=ubuntu\nVERSION_ID="24.04"\nPRETTY_NAME="Ubuntu 24.04 LTS"\n')
        self.assertIn("nobody has tried", noble.stderr)

    def test_the_container_builds_what_the_demo_builds(self):
        text = (root / "Containerfile").read_text()
        self.assertIn("FROM debian:12", text)
        for line in ("install_packages .ci/packages", "-- touchstone touchstone-fast"):
            self.assertIn(line, text)
            self.assertIn(line, (root / "demo").read_text().replace('"${options[@]}" ', ""))


unittest.main()
