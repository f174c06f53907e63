#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The package as others meet it: installed, found by another package, or beside one in a workspace.

RAVEN_BUILD names the build folder whose products are installed. RAVEN_FULL_WORKSPACE=1 builds the whole
package in the workspace too; otherwise only its messages, since the rest is built already.
"""

import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
BUILD = Path(os.environ.get("RAVEN_BUILD", ROOT / "build"))
NAME = "raven_correction"


def clean_environment():
    """Ours without the workspace that this test may itself run in."""
    ours = str(BUILD)
    environment = {}
    for key, value in os.environ.items():
        if key in ("CMAKE_PREFIX_PATH", "LD_LIBRARY_PATH", "PYTHONPATH", "PKG_CONFIG_PATH", "ROS_PACKAGE_PATH"):
            value = ":".join(part for part in value.split(":")
                             if part and not part.startswith(ours) and part != str(ROOT))
        if value:
            environment[key] = value
    environment["PATH"] = "/usr/bin:" + environment.get("PATH", "")
    return environment


def run(*command, **options):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False,
                          env=clean_environment(), timeout=600, **options)


def sourced(setup, command, **options):
    """The shell command in the environment of a setup.bash."""
    return run("bash", "-c", f'source "{setup}" && {command}', **options)


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="raven_correction_package_")
        cls.addClassCleanup(cls.folder.cleanup)
        cls.stage = Path(cls.folder.name) / "stage"
        cache = (BUILD / "CMakeCache.txt").read_text()
        prefix = re.search(r"^CMAKE_INSTALL_PREFIX:\w+=(.+)$", cache, re.MULTILINE)[1]
        # DESTDIR, because catkin writes its setup files to the prefix it was configured with.
        environment = {**clean_environment(), "DESTDIR": str(cls.stage)}
        result = subprocess.run(["cmake", "--install", str(BUILD)], env=environment, capture_output=True,
                                text=True, check=False)
        if result.returncode:
            raise RuntimeError("cmake --install failed:\n" + result.stderr)
        cls.prefix = cls.stage / prefix.lstrip("/")
        cls.setup = cls.prefix / "setup.bash"

    def ok(self, result):
        self.assertEqual(result.returncode, 0, result.stdout[-3000:] + result.stderr[-3000:])
        return result.stdout

    def test_every_shipped_file_is_installed(self):
        pairs = [("include", self.prefix / "include")]
        pairs += [(folder, self.prefix / "share" / NAME / folder)
                  for folder in ("config", "launch", "rviz", "msg", "srv")]
        listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False)
        tracked = set(listed.stdout.split("\n")) if listed.returncode == 0 else None
        missing = []
        for folder, target in pairs:
            for path in (ROOT / folder).rglob("*"):
                shipped = path.is_file() and (tracked is None or str(path.relative_to(ROOT)) in tracked)
                if shipped and not (target / path.relative_to(ROOT / folder)).is_file():
                    missing.append(str(path.relative_to(ROOT)))
        self.assertEqual(missing, [], "in the repository, but not installed")

    def test_every_node_is_installed(self):
        missing = [source.stem for source in (ROOT / "src/nodes").glob("*.cpp")
                   if not os.access(self.prefix / "lib" / NAME / source.stem, os.X_OK)]
        self.assertEqual(missing, [], "src/nodes has them, lib/raven_correction has not")

    def test_binaries_do_not_point_into_the_build_folder(self):
        binaries = [*self.prefix.glob("lib/*.so"), *(self.prefix / "lib" / NAME).glob("*")]
        self.assertTrue(binaries)
        for binary in binaries:
            dynamic = self.ok(run("readelf", "-d", binary))
            self.assertNotRegex(dynamic, r"R(UN)?PATH.*\[.+\]", f"{binary.name} has a run path")

    def test_no_installed_text_names_the_build_or_source_folder(self):
        for path in (self.prefix / "share" / NAME).rglob("*"):
            if path.is_file():
                content = path.read_bytes()
                self.assertNotIn(str(BUILD).encode() + b"/", content, path)
                self.assertNotIn(str(ROOT).encode() + b"/src", content, path)

    def test_offline_runs_from_install_space(self):
        if not (ROOT / "src/nodes/offline.cpp").exists():
            self.skipTest("src/nodes/offline.cpp is not there yet")
        self.assertIn("evaluate", self.ok(sourced(self.setup, f"rosrun {NAME} offline --help")))

    def test_ros_tools_find_the_installed_package(self):
        self.assertEqual(self.ok(sourced(self.setup, f"rospack find {NAME}")).strip(),
                         str(self.prefix / "share" / NAME))
        self.ok(sourced(self.setup, "rospack find rviz"))
        if Path("/usr/share/roscpp/package.xml").exists():  # cmake/env_hooks
            self.assertIn("/usr/share", self.ok(sourced(self.setup, "echo $ROS_PACKAGE_PATH")).strip().split(":"))

    def test_launch_files_are_found(self):
        launch_files = sorted((ROOT / "launch").glob("*.launch"))
        if not launch_files:
            self.skipTest("no launch file yet")
        for path in launch_files:
            with self.subTest(path.name):
                self.ok(sourced(self.setup, f"roslaunch --ros-args {NAME} {path.name}"))

    def test_another_package_finds_and_links_us(self):
        build = Path(self.folder.name) / "consumer"
        self.ok(sourced(self.setup, f'cmake -S "{HERE}/consumer" -B "{build}" && cmake --build "{build}"'))
        self.assertEqual(self.ok(sourced(self.setup, build / "consumer")).strip(), "core answers 42")

    def test_configures_where_googletest_is_missing(self):
        # As on a machine that has only run the demo: without the library, and without the sources that catkin
        # would build it from. They are hidden in a mount namespace of this command's own.
        command = ["cmake", "-S", ROOT, "-B", Path(self.folder.name) / "without_googletest",
                   "-DPYTHON_EXECUTABLE=/usr/bin/python3", "-DCMAKE_DISABLE_FIND_PACKAGE_GTest=ON"]
        sources = Path("/usr/src/googletest")
        if sources.exists():
            hide = ["unshare", "--mount", "sh", "-c", f'mount -t tmpfs none {sources} && exec "$@"', "sh"]
            if run(*hide, "true").returncode != 0:
                self.skipTest(f"hiding {sources} takes a mount namespace, which this user may not make")
            command = hide + command
        output = self.ok(run(*command))
        self.assertIn("GoogleTest is missing", output)

    def test_workspace(self):
        workspace = Path(self.folder.name) / "workspace"
        (workspace / "src").mkdir(parents=True)
        (workspace / "src" / NAME).symlink_to(ROOT)
        (workspace / "src/neighbour").symlink_to(HERE / "neighbour")
        command = ["catkin_make", "-C", workspace, "-j2", "--cmake-args", "-DPYTHON_EXECUTABLE=/usr/bin/python3"]
        if not os.environ.get("RAVEN_FULL_WORKSPACE"):
            command.insert(3, f"{NAME}_generate_messages_cpp")
        self.ok(run(*command))
        self.assertTrue((workspace / "devel/include" / NAME / "Pair.h").exists())
        found = self.ok(sourced(workspace / "devel/setup.bash", f"rospack find {NAME} && rospack find roscpp"))
        self.assertIn(f"src/{NAME}", found)


if __name__ == "__main__":
    unittest.main()
