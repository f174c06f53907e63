#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Counts what the tests wrote: names every failure, then prints `N passed, N failed` as the last line.

usage: count_tests.py DIRECTORY [NAME...]

DIRECTORY has JUnit XML files, one per test program (catkin's test_results). NAMEs are of what was not
completed, for instance because it hung and was killed: it left no file, and counts as failed.
Exit code 1 if a test failed or none ran. Besides the cases of the program it starts, a rostest
reports itself: that counts only if it failed, for instance because the program died.
"""

import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

PASSED, SKIPPED, FAILED = 0, 1, 2


def outcome(case):
    """Outcome of one <testcase> and, if it failed, the first lines of why."""
    for problem in case:
        if problem.tag in ("failure", "error"):
            text = (problem.get("message") or "").strip() or (problem.text or "").strip()
            return FAILED, "\n".join(text.splitlines()[:12])
    if case.find("skipped") is not None or case.get("status") == "notrun":
        return SKIPPED, ""
    return PASSED, ""


def read_cases(path):
    """(suite, name, outcome, text) of every case of one file; a file that cannot be read is a failure."""
    try:
        root = ElementTree.parse(path).getroot()
    except (ElementTree.ParseError, OSError) as error:
        yield path.stem, "result file", FAILED, f"{path}: {error} (was the test killed?)"
        return
    cases = list(root.iter("testcase"))
    if not cases:
        yield path.stem, "result file", FAILED, f"{path}: holds no test (did what sets them up fail?)"
    for case in cases:
        suite = case.get("classname") or path.stem
        result, text = outcome(case)
        if result != PASSED or not suite.startswith("rostest.runner"):
            yield suite, case.get("name", "?"), result, text


def main():
    if len(sys.argv) < 2:
        print(__doc__, file=sys.stderr)
        return 2
    counts = {PASSED: 0, SKIPPED: 0, FAILED: 0}
    for path in sorted(Path(sys.argv[1]).rglob("*.xml")):
        for suite, name, result, text in read_cases(path):
            counts[result] += 1
            if result == FAILED:
                print(f"FAILED {suite}.{name}    ({path.name})\n  " + text.replace("\n", "\n  "))
    for name in sys.argv[2:]:
        counts[FAILED] += 1
        print(f"FAILED {name}\n  was not completed; was it killed?")
    none_ran = counts[PASSED] + counts[FAILED] == 0
    if none_ran:
        print(f"no test ran: {sys.argv[1]} holds no result")
    skipped = f", {counts[SKIPPED]} skipped" if counts[SKIPPED] else ""
    print(f"{counts[PASSED]} passed, {counts[FAILED]} failed{skipped}")
    return 1 if counts[FAILED] or none_ran else 0


if __name__ == "__main__":
    sys.exit(main())
