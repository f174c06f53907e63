# SPDX-License-Identifier: BSD-3-Clause
"""Rules about the text of files: licence line, opening comment, messages, launch files, YAML, paths."""

import re
import xml.etree.ElementTree as ElementTree

import yaml

from project import Finding

SOURCES = r".*(\.(h|cpp|cc|py|sh|cmake|launch|test|yaml|yml|msg|srv|action)|CMakeLists\.txt|\.clang-tidy)"
LICENCE = "SPDX-License-Identifier: BSD-3-Clause"


def is_script(project, name):
    return project.is_text(name) and project.text(name).startswith("#!")


def check_licence(project):
    """Every source, script, message, launch and configuration file names its licence at its top."""
    for name in project.files:
        if re.fullmatch(SOURCES, name) or is_script(project, name):
            if LICENCE not in "\n".join(project.text(name).splitlines()[:3]):
                yield Finding(name, 1, "licence", f'write "{LICENCE}" as a comment in its first lines')


def check_opening(project):
    """A header says in its first lines which question it answers, and guards itself."""
    for name in project.matching(r"(include|src|test|bench|fuzz)/.*\.h"):
        lines = project.text(name).splitlines()
        if len(lines) < 2 or not re.match(r"// \w+", lines[1]):
            yield Finding(name, 2, "opening", "say in 2 to 4 lines of comment what this header answers")
        # A src/**/*_body.h is the body of several sources that differ by a macro, not an interface.
        if "#pragma once" not in lines and not re.fullmatch(r"src/.*_body\.h", name):
            yield Finding(name, 1, "opening", "#pragma once is missing")


def check_hygiene(project):
    """No tabs, trailing blanks, foreign line ends, or paths of one person's machine; TODOs have issues."""
    private = re.compile(r"(?<![\w.}])/(home|root|Users)/\w")
    todo = re.compile(r"\b(TODO|FIXME|XXX)\b(?!\(#\d+)")
    for name in project.files:
        if not project.is_text(name) or name.startswith(("LICENSE", "test/lint/")):
            continue
        content = project.text(name)
        if content and not content.endswith("\n"):
            yield Finding(name, content.count("\n") + 1, "hygiene", "end the last line with a line feed")
        for number, line in enumerate(content.split("\n"), start=1):
            if line.endswith("\r"):
                yield Finding(name, number, "hygiene", "ends in CR LF; use LF")
            elif line != line.rstrip() and not name.endswith((".csv", ".md", ".rviz")):
                yield Finding(name, number, "hygiene", "trailing blanks; remove them")
            if "\t" in line and not name.endswith((".csv", ".svg")):
                yield Finding(name, number, "hygiene", "contains a tab; use spaces")
            if private.search(line):
                yield Finding(name, number, "hygiene", "names a folder of one machine; use a relative path")
            if todo.search(line):
                yield Finding(name, number, "hygiene", "open point without an issue; write TODO(#number)")


def check_messages(project):
    """Every field of a message or service has a comment; constants may share the one above them."""
    field = re.compile(r"^\s*[\w/]+(\[\d*\])?\s+\w+\s*(?P<constant>=[^#]*)?(?P<comment>#\s*\S.*)?$")
    for name in project.matching(r"(msg|srv|action)/[^/]+\.(msg|srv|action)"):
        documented = False  # a comment directly above covers the field below it
        for number, line in project.lines(name):
            found = field.match(line)
            if found and not found["constant"] and not found["comment"] and not documented:
                yield Finding(name, number, "messages", f'"{line.strip()}" has no comment; say what it is, '
                              "its unit in [] and its frame")
            documented = line.lstrip().startswith("#") and LICENCE not in line


def check_launch_documentation(project):
    """Every <arg> that a user can set has a doc attribute."""
    for name in project.matching(r"launch/.*\.(launch|xml)"):
        try:
            arguments = ElementTree.fromstring(project.text(name)).findall("arg")
        except ElementTree.ParseError as error:
            yield Finding(name, error.position[0], "launch", f"is not valid XML: {error}")
            continue
        for argument in arguments:
            if "value" not in argument.attrib and not argument.get("doc", "").strip():
                line = next((number for number, text in project.lines(name)
                             if re.search(rf"""<arg\b.*name=["']{argument.get("name")}["']""", text)), 1)
                yield Finding(name, line, "launch", f'<arg name="{argument.get("name")}"> has no doc; say '
                              "what it is, with its unit")


class StrictLoader(yaml.SafeLoader):
    """YAML as PyYAML reads it, except that a key given twice is an error and not silently the last."""

    def construct_mapping(self, node, deep=False):
        seen = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            if isinstance(key, (str, int, float, bool)) and key in seen:
                raise yaml.constructor.ConstructorError(
                    None, None, f"the key {key!r} is given twice", key_node.start_mark)
            if isinstance(key, (str, int, float, bool)):
                seen.add(key)
        return super().construct_mapping(node, deep)


def check_yaml(project):
    """Every configuration, rviz and test YAML file loads, and holds no key twice."""
    for name in project.matching(r".*\.(yaml|yml|rviz)"):
        try:
            if yaml.load(project.text(name), Loader=StrictLoader) is None:
                yield Finding(name, 1, "yaml", "is empty; a file that says nothing can go")
        except yaml.YAMLError as error:
            mark = getattr(error, "problem_mark", None)
            yield Finding(name, mark.line + 1 if mark else 1, "yaml", getattr(error, "problem", str(error)))


def known_tests(project):
    """Suite.Name of every gtest and every unittest method (ProcessTest: test/nodes/private_master.py)."""
    for name in project.matching(r"test/.*\.(cpp|py)"):
        suite = None
        for found in re.finditer(r"^TEST(?:_F|_P)?\((\w+),\s*(\w+)\)", project.text(name), re.MULTILINE):
            yield f"{found[1]}.{found[2]}"
        for line in project.text(name).splitlines():
            if found := re.match(r"class (\w+)\((?:unittest\.TestCase|ProcessTest)\)", line):
                suite = found[1]
            elif found := re.match(r"    def (test_\w+)\(", line):
                yield f"{suite}.{found[1]}"


def check_faults(project):
    """Every row of the table of faults (doc/faults.md) names tests, and they exist."""
    name = "doc/faults.md"
    if name not in project.files:
        return
    tests = set(known_tests(project))
    for number, line in project.lines(name):
        if not line.startswith("|") or set(line) <= set("|- ") or line.startswith("| fault"):
            continue
        named = re.findall(r"`(\w+\.\w+)`", line.rstrip("| ").rsplit("|", 1)[-1])
        if not named:
            yield Finding(name, number, "faults", "names no test; write it, and name it as `Suite.Test`")
        for test in named:
            if test not in tests:
                yield Finding(name, number, "faults", f"there is no test {test}")
