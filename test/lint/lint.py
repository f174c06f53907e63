#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Holds the project against its conventions: ./run lint

Each check is a function that yields findings, `path:line: [rule] what is wrong and what to do`.
Exit code 0 if there are none, 1 if there are, 2 for bad usage.
"""

import argparse
import sys
import time
import traceback
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import rooms
import texts
import tools
from project import Finding, Project, Skipped

CHECKS = {
    "rooms": rooms.check_rooms,
    "independent": rooms.check_independent,
    "core": rooms.check_core_without_ros,
    "licence": texts.check_licence,
    "opening": texts.check_opening,
    "hygiene": texts.check_hygiene,
    "messages": texts.check_messages,
    "launch": texts.check_launch_documentation,
    "yaml": texts.check_yaml,
    "faults": texts.check_faults,
    "format": tools.check_format,
    "architecture": tools.check_architecture,
    "catkin": tools.check_catkin,
    "shell": tools.check_shell,
    "python": tools.check_python,
    "alone": tools.check_headers_alone,
}
ON_REQUEST = {"names": tools.check_names, "tidy": tools.check_tidy}  # clang-tidy takes minutes


def run_check(name, check, project):
    """(findings, reason it was skipped or None, seconds) of one check; a crash is a finding."""
    start = time.monotonic()
    skipped = None
    try:
        findings = list(check(project))
    except Skipped as reason:
        findings, skipped = [], str(reason)
    except Exception:  # pylint: disable=broad-except
        last = traceback.format_exc().strip().splitlines()
        findings = [Finding("test/lint", 1, name, "the check itself failed: " + " | ".join(last[-3:]))]
    return findings, skipped, time.monotonic() - start


def write_results(path, results):
    """JUnit XML with one case per check, for catkin_test_results and scripts/count_tests.py."""
    suite = ElementTree.Element("testsuite", name="lint", tests=str(len(results)), errors="0",
                                failures=str(sum(bool(findings) for _, findings, _, _ in results)))
    for name, findings, skipped, seconds in results:
        case = ElementTree.SubElement(suite, "testcase", classname="lint", name=name, time=f"{seconds:.3f}")
        if findings:
            ElementTree.SubElement(case, "failure", type="", message="\n".join(map(str, findings)))
        elif skipped:
            ElementTree.SubElement(case, "skipped", message=skipped)
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    ElementTree.ElementTree(suite).write(path, encoding="utf-8", xml_declaration=True)


def main():
    everything = {**CHECKS, **ON_REQUEST}
    epilog = "checks:\n" + "\n".join(f"  {name:13} {check.__doc__}" for name, check in everything.items())
    parser = argparse.ArgumentParser(prog="./run lint", description=__doc__, epilog=epilog,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checks", nargs="*", metavar="CHECK", help="only these")
    parser.add_argument("--tidy", action="store_true", help="all of clang-tidy as well (slow)")
    parser.add_argument("--build", help="build folder; without it, checks that need one are skipped")
    parser.add_argument("--root", default=Path(__file__).resolve().parents[2], help="folder to check")
    parser.add_argument("--results", help="write JUnit XML to this file")
    arguments = parser.parse_args()
    unknown = [name for name in arguments.checks if name not in everything]
    if unknown:
        parser.error(f"no such check: {', '.join(unknown)}; there are {', '.join(everything)}")
    chosen = arguments.checks or list(CHECKS)
    if arguments.tidy and "tidy" not in chosen:
        chosen.append("tidy")

    project = Project(arguments.root, arguments.build)
    results = []
    for name in chosen:
        findings, skipped, seconds = run_check(name, everything[name], project)
        results.append((name, findings, skipped, seconds))
        state = f"{len(findings)} findings" if findings else f"skipped: {skipped}" if skipped else "ok"
        print(f"lint {name:13} {state}  ({seconds:.1f} s)", flush=True)
        for finding in findings:
            print(f"  {finding}", flush=True)
    if arguments.results:
        write_results(arguments.results, results)
    return 1 if any(findings for _, findings, _, _ in results) else 0


if __name__ == "__main__":
    sys.exit(main())
