#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Every check of the lint turns red on the fault it is for, and stays green without it."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

# pylint: disable=wrong-import-position
import rooms
import texts
import tools
from project import Project, Skipped

SPDX = "// SPDX-License-Identifier: BSD-3-Clause\n"
HEADER = SPDX + "// What this answers.\n#pragma once\n"


class Lint(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.write("test/lint/rooms.yaml", (HERE / "rooms.yaml").read_text())

    def write(self, name, content):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())

    def findings(self, check, build=None):
        try:
            return [str(finding) for finding in check(Project(self.root, build))]
        except Skipped as reason:
            self.skipTest(str(reason))

    def assert_red(self, check, where, text, build=None):
        found = self.findings(check, build)
        self.assertEqual(len(found), 1, found)
        self.assertTrue(found[0].startswith(where + ":"), found[0])
        self.assertIn(text, found[0])

    def assert_green(self, check, build=None):
        self.assertEqual(self.findings(check, build), [])

    # --- rooms ------------------------------------------------------------------------------------
    def test_rooms_order(self):
        self.write("include/raven_correction/geometry/pose.h", HEADER + "#include <Eigen/Core>\n")
        self.write("include/raven_correction/error.h", HEADER + "#include <string>\n")
        self.write("include/raven_correction/dataset/pairs.h", HEADER + "#include <vector>\n"
                   '#include "raven_correction/error.h"\n#include "raven_correction/geometry/pose.h"\n')
        self.write("src/cleaning/lmeds.cpp", SPDX + '#include "raven_correction/dataset/pairs.h"\n')
        self.assert_green(rooms.check_rooms)
        self.write("src/geometry/pose.cpp", SPDX + '#include "raven_correction/dataset/pairs.h"\n')
        self.assert_red(rooms.check_rooms, "src/geometry/pose.cpp:2", "may not use room dataset")

    def test_rooms_regression_knows_no_robots(self):
        self.write("include/raven_correction/geometry/pose.h", HEADER)
        self.write("src/regression/gp.cpp", SPDX + "#include <LBFGSB.h>\n#include <omp.h>\n")
        self.assert_green(rooms.check_rooms)
        self.write("src/regression/gp.cpp", SPDX + '#include "raven_correction/geometry/pose.h"\n')
        self.assert_red(rooms.check_rooms, "src/regression/gp.cpp:2", "may not use room geometry")
        self.write("src/regression/gp.cpp", SPDX + "#include <yaml-cpp/yaml.h>\n")
        self.assert_red(rooms.check_rooms, "src/regression/gp.cpp:2", "may not use yaml-cpp")

    def test_independent_plant(self):
        self.write("include/raven_correction/simulation/play.h", HEADER)
        self.write("include/raven_correction/robot/chain.h", HEADER)
        self.write("test/plant/joint.h", HEADER)
        play = SPDX + '#include "raven_correction/simulation/play.h"\n'
        self.write("test/plant/joint.cpp", SPDX + '#include "plant/joint.h"\n#include <cmath>\n'
                   '#include "raven_correction/robot/chain.h"\n')
        self.write("test/plant/joint_test.cpp", play)
        self.assert_green(rooms.check_independent)
        self.write("test/plant/joint.cpp", play)
        self.assert_red(rooms.check_independent, "test/plant/joint.cpp:2", "may not use room simulation")

    def test_rooms_core_without_ros(self):
        for header in ("ros/ros.h", "geometry_msgs/Pose.h", "tf2_ros/buffer.h", "rosbag/bag.h",
                       "raven_correction/Pair.h"):
            self.write("src/dataset/bag.cpp", SPDX + f"#include <{header}>\n")
            self.assert_red(rooms.check_rooms, "src/dataset/bag.cpp:2", "may not use ROS")
        (self.root / "src/dataset/bag.cpp").rename(self.root / "src/bag.cpp")
        (self.root / "src/ros").mkdir()
        (self.root / "src/bag.cpp").rename(self.root / "src/ros/bag.cpp")
        self.assert_green(rooms.check_rooms)

    def test_rooms_strangers(self):
        self.write("src/attic/old.cpp", SPDX)
        self.assert_red(rooms.check_rooms, "src/attic/old.cpp:1", "lies in no room")
        self.write("src/attic/old.cpp", "")
        (self.root / "src/attic/old.cpp").unlink()
        self.write("src/dataset/a.cpp", SPDX + "#include <gsl/gsl_math.h>\n")
        self.assert_red(rooms.check_rooms, "src/dataset/a.cpp:2", "does not know")
        self.write("src/dataset/a.cpp", SPDX + '#include "raven_correction/dataset/gone.h"\n')
        self.assert_red(rooms.check_rooms, "src/dataset/a.cpp:2", "does not exist")

    def test_core_links(self):
        library = self.root / "build/devel/lib/libraven_correction_core.so"
        library.parent.mkdir(parents=True)
        command = ["g++", "-shared", "-fPIC", "-x", "c++", "-", "-o", str(library)]
        subprocess.run(command, input=b"int f() { return 1; }", check=True)
        self.assert_green(rooms.check_core_without_ros, self.root / "build")
        fake = self.root / "librostime.so"
        subprocess.run(["g++", "-shared", "-fPIC", "-x", "c++", "-", "-Wl,-soname,librostime.so",
                        "-o", str(fake)], input=b"int g() { return 1; }", check=True)
        subprocess.run(command + ["-x", "none", "-Wl,--no-as-needed", str(fake)],
                       input=b"int f() { return 1; }", check=True)
        self.assert_red(rooms.check_core_without_ros, "CMakeLists.txt:1", "librostime.so",
                        self.root / "build")

    # --- texts ------------------------------------------------------------------------------------
    def test_licence(self):
        self.write("src/geometry/a.cpp", SPDX)
        self.write("doc/a.md", "no licence line needed\n")
        self.assert_green(texts.check_licence)
        self.write("src/geometry/a.cpp", "int a;\n")
        self.assert_red(texts.check_licence, "src/geometry/a.cpp:1", "SPDX")
        self.write("src/geometry/a.cpp", SPDX)
        self.write("scripts/tool", "#!/bin/sh\n")
        self.assert_red(texts.check_licence, "scripts/tool:1", "SPDX")

    def test_opening(self):
        self.write("include/raven_correction/geometry/a.h", HEADER)
        self.assert_green(texts.check_opening)
        self.write("include/raven_correction/geometry/a.h", SPDX + "#pragma once\n")
        self.assert_red(texts.check_opening, "include/raven_correction/geometry/a.h:2", "comment")
        self.write("include/raven_correction/geometry/a.h", SPDX + "// What it answers.\n")
        self.write("src/geometry/loop_body.h", SPDX + "// Body of two sources.\n")
        self.assert_red(texts.check_opening, "include/raven_correction/geometry/a.h:1", "pragma")

    def test_hygiene(self):
        self.write("doc/a.md", "a path: ../data and /usr/share, {root}/home/x, http://x.org/home/y\n")
        self.assert_green(texts.check_hygiene)
        for content, text in (("a", "line feed"), ("a \n", "trailing"), ("a\tb\n", "tab"), ("a\r\n", "CR LF"),
                              ("see /home/me\n", "one machine"), ("cd /root/x\n", "one machine"),
                              ("// TODO later\n", "issue")):
            self.write("doc/a.txt", content)
            self.assert_red(texts.check_hygiene, "doc/a.txt:1", text)
        self.write("doc/a.txt", "TODO(#7): later\n")
        self.assert_green(texts.check_hygiene)

    def test_messages(self):
        good = "uint8 OFF=0\n\nHeader header  # stamp: when [s]\nfloat64[] a  # b [m]\n# above [m]\nfloat64 c\n"
        self.write("msg/A.msg", good)
        self.assert_green(texts.check_messages)
        self.write("msg/A.msg", good + "float64[3] width\n")
        self.assert_red(texts.check_messages, "msg/A.msg:7", "width")
        self.write("msg/A.msg", good)
        self.write("srv/B.srv", "string file  # to read\n---\nbool success\n")
        self.assert_red(texts.check_messages, "srv/B.srv:3", "success")

    def test_launch(self):
        good = '<launch>\n<arg name="a" default="1" doc="length [m]"/>\n<arg name="b" value="$(arg a)"/>\n'
        self.write("launch/a.launch", good + "</launch>\n")
        self.assert_green(texts.check_launch_documentation)
        self.write("launch/a.launch", good + '<arg name="c" default=""/>\n</launch>\n')
        self.assert_red(texts.check_launch_documentation, "launch/a.launch:4", '"c"')
        self.write("launch/a.launch", good)
        self.assert_red(texts.check_launch_documentation, "launch/a.launch:4", "XML")

    def test_yaml(self):
        self.write("config/a.yaml", "a: 1\nb: {a: 2}\n")
        self.assert_green(texts.check_yaml)
        self.write("config/a.yaml", "a: 1\nb: 2\na: 3\n")
        self.assert_red(texts.check_yaml, "config/a.yaml:3", "twice")
        self.write("config/a.yaml", "a: 1\nb: [2\n")
        self.assert_red(texts.check_yaml, "config/a.yaml:3", "expected")
        self.write("config/a.yaml", "# nothing\n")
        self.assert_red(texts.check_yaml, "config/a.yaml:1", "empty")

    # --- tools ------------------------------------------------------------------------------------
    def test_faults(self):
        self.write("test/nodes/a.cpp", SPDX + "TEST_F(Faults, NaN) {}\nTEST(Faults,\n     Long) {}\n")
        self.write("test/nodes/b.py", "class Killed(unittest.TestCase):\n    def test_node(self):\n")
        head = "| fault | behaviour | test |\n|---|---|---|\n"
        self.write("doc/faults.md", head + "| a | b | `Faults.NaN`, `Faults.Long`, `Killed.test_node` |\n")
        self.assert_green(texts.check_faults)
        self.write("doc/faults.md", head + "| a | `Faults.NaN` | `Faults.Other` |\n")
        self.assert_red(texts.check_faults, "doc/faults.md:3", "no test Faults.Other")
        self.write("doc/faults.md", head + "| a | `Faults.NaN` | by hand |\n")
        self.assert_red(texts.check_faults, "doc/faults.md:3", "names no test")

    def test_format(self):
        self.write(".clang-format", "BasedOnStyle: Google\n")
        self.write("src/geometry/a.cpp", "int a = 1;\n")
        self.assert_green(tools.check_format)
        self.write("src/geometry/a.cpp", "int a =  1 ;\nint b =  1 ;\n")
        self.assert_red(tools.check_format, "src/geometry/a.cpp:1", "clang-format -i")

    def test_headers_alone(self):
        build = self.compile_database("-isystem /usr/include/eigen3")
        name = "include/raven_correction/geometry/a.h"
        self.write(name, HEADER + "#include <string>\ninline std::string f() { return {}; }\n")
        self.assert_green(tools.check_headers_alone, build)
        self.write(name, HEADER + "inline std::string f() { return {}; }\n")
        self.assert_red(tools.check_headers_alone, name + ":1", "compile alone", build)
        self.write(name, SPDX + "struct A {};\n")
        self.assert_red(tools.check_headers_alone, name + ":1", "redefinition", build)
        # The build compiles what a source includes first; that it may stand twice, it does not show.
        self.write("src/regression/a.cpp", f'{SPDX}#include "raven_correction/geometry/a.h"\n')
        self.assert_red(tools.check_headers_alone, name + ":1", "redefinition", build)
        self.write(name, HEADER + "this the build would have refused\n")
        self.assert_green(tools.check_headers_alone, build)
        self.write("src/regression/a.cpp", f'{SPDX}#include <string>\n#include "raven_correction/geometry/a.h"\n')
        self.assert_red(tools.check_headers_alone, name + ":1", "compile alone", build)

    def compile_database(self, flag):
        build = self.root / "build"
        self.write("build/compile_commands.json", f"""[{{"directory": "{self.root}",
          "command": "/usr/bin/c++ -std=c++17 {flag} -I{self.root}/include -c src/regression/a.cpp",
          "file": "src/regression/a.cpp"}}]""")
        return build

    def test_names(self):
        build = self.compile_database("-O2")
        self.write(".clang-tidy", (HERE.parents[1] / ".clang-tidy").read_text())
        self.write("include/raven_correction/regression/a.h", HEADER +
                   "struct CamelCase {\n  double public_field = 0.0;\n\n private:\n  int hidden_ = 0;\n};\n")
        good = (SPDX + '#include "raven_correction/regression/a.h"\n'
                "constexpr double kLimit = 1.0;\nenum class Status { kOk, kBad };\n"
                "double lengthOf(double X_base_tool, double K) { return X_base_tool * K; }\n"
                "const double X_base_mocap = 1.0;\n"
                "template <int kSize, int N, typename Type> Type f() { return kSize * N; }\n"
                "extern \"C\" void* __libc_malloc(unsigned long size);\n"
                "struct Fixture { protected: int bare = 0; int own_ = 0; };\n"
                "void g() { const auto twiceOf = [](int i) { return 2 * i; }; twiceOf(kLimit); }\n")
        self.write("src/regression/a.cpp", good)
        self.assert_green(tools.check_names, build)
        for bad in ("double length_of() { return 1.0; }", "struct snake_case {};",
                    "constexpr double limit = 2.0;", "enum class Colour { RED };",
                    "double f(double camelCase) { return camelCase; }"):
            self.write("src/regression/a.cpp", good + bad + "\n")
            self.assert_red(tools.check_names, "src/regression/a.cpp:11", "invalid case style", build)
        self.write("src/regression/a.cpp", good)
        self.write("include/raven_correction/regression/a.h", HEADER +
                   "class CamelCase {\n  int hidden = 0;\n};\n")
        self.assert_red(tools.check_names, "include/raven_correction/regression/a.h:5", "hidden", build)

    def test_architecture(self):
        self.write("include/raven_correction/regression/a.h", HEADER + "#include <Eigen/Core>\n")
        self.write("src/regression/a.cpp", SPDX + "#include <cmath>\n")
        self.assert_green(tools.check_architecture, self.compile_database("-mavx2"))
        self.write("src/regression/a.cpp", SPDX + '#include "raven_correction/regression/a.h"\n')
        self.assert_green(tools.check_architecture, self.compile_database("-O2"))
        self.assert_red(tools.check_architecture, "include/raven_correction/regression/a.h:4", "-mavx2",
                        self.compile_database("-mavx2"))

    def test_catkin(self):
        self.write("package.xml", """<package format="2"><name>raven_correction</name><version>0.1.0</version>
          <description>d</description><maintainer email="a@b.invalid">m</maintainer><license>BSD</license>
          <buildtool_depend>catkin</buildtool_depend></package>""")
        good = ("cmake_minimum_required(VERSION 3.16)\nproject(raven_correction)\n"
                "find_package(catkin REQUIRED)\ncatkin_package()\n")
        self.write("CMakeLists.txt", good)
        self.assert_green(tools.check_catkin)
        self.write("CMakeLists.txt", good + "install(DIRECTORY nowhere DESTINATION share)\n")
        self.assert_red(tools.check_catkin, "CMakeLists.txt:5", "nowhere")

    def test_shell(self):
        self.write("scripts/a.sh", '#!/bin/bash\nset -e\nls "$1"\n')
        self.assert_green(tools.check_shell)
        self.write("scripts/a.sh", "#!/bin/bash\nset -e\nls $1\n")
        self.assert_red(tools.check_shell, "scripts/a.sh:3", "SC2086")

    def test_python(self):
        self.write("scripts/a.py", "a = 1\n")
        self.assert_green(tools.check_python)
        self.write("scripts/a.py", "a = 1\nb = (\n")
        self.assert_red(tools.check_python, "scripts/a.py:2", "never closed")

    # --- the program --------------------------------------------------------------------------------
    def test_exit_codes(self):
        def lint(*arguments):
            return subprocess.run([sys.executable, str(HERE / "lint.py"), "--root", str(self.root), *arguments],
                                  capture_output=True, text=True, check=False, env=os.environ)
        self.assertEqual(lint("licence").returncode, 0)
        self.write("src/geometry/a.cpp", "int a;\n")
        results = self.root / "lint.xml"
        red = lint("licence", "yaml", "alone", "--results", str(results))
        self.assertEqual(red.returncode, 1, red.stdout + red.stderr)
        self.assertIn("src/geometry/a.cpp:1: [licence]", red.stdout)
        count = subprocess.run([sys.executable, str(HERE.parents[1] / "scripts/count_tests.py"), str(self.root)],
                               capture_output=True, text=True, check=False)
        self.assertEqual(count.stdout.splitlines()[-1], "1 passed, 1 failed, 1 skipped")
        self.assertEqual(count.returncode, 1)
        self.assertEqual(lint("no_such_check").returncode, 2)


if __name__ == "__main__":
    unittest.main()
