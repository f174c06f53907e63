#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""./run: what it asks apt for, when it builds, and that exit codes and stdout belong to the program."""

import os
import shutil
import subprocess
import sys
import tempfile
import textwrap
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("RAVEN_BUILD", ROOT / "build"))


def bash(script, **variables):
    """Runs `script` after the libraries of ./run, with `variables` set before."""
    settings = {"noetic": "", "root": str(ROOT), "build": str(BUILD), **variables}
    head = "set -euo pipefail\n" + "".join(f"{name}='{value}'\n" for name, value in settings.items())
    for library in ("report", "packages", "build"):
        head += f"source '{ROOT}/scripts/lib/{library}.sh'\n"
    environment = {key: value for key, value in os.environ.items() if key != "RAVEN_SKIP_APT"}
    return subprocess.run(["bash", "-c", head + script], capture_output=True, text=True, check=False,
                          env=environment)


class Run(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.list = self.folder / "list.apt"
        self.list.write_text("# comment\n\ng++\nlibroscpp-dev  ros:roscpp\nlibtf2-ros-dev  ros:tf2_ros\n")

    # A machine that has g++, and has had libroscpp-dev but lost it.
    dpkg = """dpkg-query() { printf 'g++ installed\\nlibroscpp-dev config-files\\n'; return 1; }
              apt-cache() { printf '  Candidate: 1.0\\n'; }
              may_become_root() { true; }
              as_root() { printf 'ROOT %s\\n' "$*" >&2; }\n"""

    def missing(self, **variables):
        return bash(self.dpkg + f"missing_packages '{self.list}'", **variables).stdout.split()

    def test_missing_packages(self):
        self.assertEqual(self.missing(), ["libroscpp-dev", "libtf2-ros-dev"])

    def test_noetic_takes_the_place_of_debian(self):
        (self.folder / "share/roscpp").mkdir(parents=True)
        (self.folder / "share/roscpp/package.xml").touch()
        self.assertEqual(self.missing(noetic=self.folder), ["ros-noetic-tf2-ros"])

    def test_apt_is_called_once_and_only_for_what_is_missing(self):
        result = bash(self.dpkg + f"install_packages '{self.list}'")
        self.assertEqual(result.returncode, 0, result.stderr)
        calls = [line for line in result.stderr.splitlines() if line.startswith("ROOT")]
        self.assertEqual(len(calls), 2, calls)
        self.assertIn(" update", calls[0])
        self.assertTrue(calls[1].endswith("--no-install-recommends libroscpp-dev libtf2-ros-dev"), calls[1])
        self.list.write_text("g++\n")
        result = bash(self.dpkg + f"install_packages '{self.list}'")
        self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_refusals_name_the_packages_and_the_remedy(self):
        result = bash(self.dpkg + f"may_become_root() {{ false; }}\ninstall_packages '{self.list}'")
        self.assertEqual(result.returncode, 2)
        self.assertIn("As root: apt-get install --no-install-recommends libroscpp-dev", result.stderr)
        result = bash(self.dpkg + "apt-cache() { printf '  Candidate: (none)\\n'; }\n"
                      f"install_packages '{self.list}'")
        self.assertEqual(result.returncode, 2)
        self.assertIn("apt does not know libroscpp-dev libtf2-ros-dev", result.stderr)
        result = bash(self.dpkg + "as_root() { [[ $* == *update* ]]; }\n" f"install_packages '{self.list}'")
        self.assertEqual(result.returncode, 1)
        self.assertIn("apt could not install", result.stderr)

    def test_every_listed_package_is_known_to_apt(self):
        if "bookworm" not in Path("/etc/os-release").read_text():
            self.skipTest("the lists hold names of Debian 12")
        wanted = {line.split()[0] for path in ROOT.glob("dependencies*.apt")
                  for line in path.read_text().splitlines() if line.strip() and not line.startswith("#")}
        shown = subprocess.run(["apt-cache", "show", "--no-all-versions", *sorted(wanted)],
                               capture_output=True, text=True, check=False).stdout
        known = {line.split()[1] for line in shown.splitlines() if line.startswith("Package: ")}
        self.assertEqual(sorted(wanted - known), [])

    def test_builds_only_when_a_source_changed(self):
        source = self.folder / "src/geometry/a.cpp"
        source.parent.mkdir(parents=True)
        source.touch()
        stamp = self.folder / "stamp"

        def changed():
            return bash(f"changed_since '{stamp}'", root=self.folder).returncode == 0
        self.assertTrue(changed(), "never built")
        for path in (self.folder / "src", source.parent, source):
            os.utime(path, (1e9, 1e9))
        stamp.touch()
        self.assertFalse(changed(), "nothing happened since")
        os.utime(source, (4e9, 4e9))
        self.assertTrue(changed(), "a file was edited")
        os.utime(source, (1e9, 1e9))
        self.assertFalse(changed())
        os.utime(stamp, (2e9, 2e9))
        source.rename(source.with_name("b.cpp"))  # touches the folder, not the file
        os.utime(source.parent, (3e9, 3e9))
        self.assertTrue(changed(), "a file came or went")

    def test_a_build_made_elsewhere_is_thrown_away(self):
        (self.folder / "build").mkdir()
        cache = self.folder / "build/CMakeCache.txt"
        cache.write_text(f"CMAKE_HOME_DIRECTORY:INTERNAL={self.folder}\n")
        here = {"root": self.folder, "build": self.folder / "build"}
        bash("forget_foreign_build", **here)
        self.assertTrue(cache.exists())
        cache.write_text("CMAKE_HOME_DIRECTORY:INTERNAL=/somewhere/else\n")
        bash("forget_foreign_build", **here)
        self.assertFalse(cache.exists())

    def run_it(self, *arguments):
        environment = {name: value for name, value in os.environ.items() if not name.startswith("MAKE")}
        return subprocess.run([str(ROOT / "run"), *arguments], capture_output=True, text=True, check=False,
                              env=environment)

    def test_usage(self):
        self.assertEqual(self.run_it("help").returncode, 0)
        self.assertIn("offline ARGS", self.run_it("help").stdout)
        unknown = self.run_it("tset")
        self.assertEqual(unknown.returncode, 2)
        self.assertIn("unknown command 'tset'", unknown.stderr)
        self.assertEqual(self.run_it("exec").returncode, 2)
        self.assertIn("NAME one of", self.run_it("bench").stderr)
        for arguments, reason in ((("sanitize", "nonsense"), "usage"),
                                  (("sanitize", "address", "nope"), "there is no test 'nope'"),
                                  (("fuzz", "nope"), "TARGET one of: csv model"),
                                  (("fuzz", "--seconds", "0"), "not a whole number"),
                                  (("fuzz", "--seconds", "1"), "less than a second for each")):
            refused = self.run_it(*arguments)
            self.assertEqual((refused.returncode, reason in refused.stderr), (2, True), refused.stderr)

    def test_offline_and_exec_pass_everything_through(self):
        if BUILD != ROOT / "build" or not (BUILD / ".built-all").exists():
            self.skipTest("this is not the build folder of ./run")
        result = self.run_it("exec", "bash", "-c", "echo out; exit 7")
        self.assertEqual((result.returncode, result.stdout), (7, "out\n"), result.stderr)
        result = self.run_it("exec", "rospack", "find", "rviz")
        self.assertIn("/rviz", result.stdout, result.stderr[-3000:])
        offline = BUILD / "devel/lib/raven_correction/offline"
        if not shutil.which(str(offline)):
            self.skipTest("there is no offline program yet")
        self.assertIn("SUBCOMMAND", self.run_it("exec", "offline", "--help").stdout)  # its programs are commands
        for arguments in (("--help",), ("no_such_command",)):
            ours = self.run_it("offline", *arguments)
            bare = subprocess.run([str(offline), *arguments], capture_output=True, text=True, check=False)
            self.assertEqual((ours.returncode, ours.stdout), (bare.returncode, bare.stdout))

    def count(self, cases):
        """Results of a file with these cases: exit code of what ran it, last line and exit code of the count."""
        file, results = self.folder / "cases.py", self.folder / "results"
        file.write_text("import unittest\n" + textwrap.dedent(cases))
        ran = subprocess.run([sys.executable, str(ROOT / "test/support/run_unittest.py"), str(results / "cases.xml"),
                              str(file)], capture_output=True, text=True, check=False)
        counted = subprocess.run([sys.executable, str(ROOT / "scripts/count_tests.py"), str(results)],
                                 capture_output=True, text=True, check=False)
        return ran.returncode, counted.stdout.splitlines()[-1], counted.returncode

    def test_no_failure_is_lost(self):
        self.assertEqual(self.count("""
            class Cases(unittest.TestCase):
                def test_of_three(self):
                    for number in (1, 2, 3):
                        with self.subTest(number=number):
                            self.assertEqual(number, 2)
                def test_that_passes(self):
                    pass
                def test_that_cannot_run_here(self):
                    self.skipTest("why")
            class NotSetUp(unittest.TestCase):
                @classmethod
                def setUpClass(cls):
                    raise RuntimeError("no")
                def test_never_reached(self):
                    pass
            """), (1, "1 passed, 3 failed, 1 skipped", 1))
        self.assertEqual(self.count("""
            class Cases(unittest.TestCase):
                def test_that_passes(self):
                    with self.subTest():
                        pass
            """), (0, "1 passed, 0 failed", 0))
        self.assertEqual(self.count("raise RuntimeError")[1:], ("0 passed, 1 failed", 1))
        (self.folder / "results/cases.xml").write_text("<testsuite/>")
        for killed, failed in (((), 1), (("that hung",), 2)):
            counted = subprocess.run([sys.executable, str(ROOT / "scripts/count_tests.py"), str(self.folder), *killed],
                                     capture_output=True, text=True, check=False)
            self.assertEqual((counted.returncode, counted.stdout.splitlines()[-1]), (1, f"0 passed, {failed} failed"))


if __name__ == "__main__":
    unittest.main()
