# SPDX-License-Identifier: BSD-3-Clause
"""What tests of whole processes share: where the nodes are, waiting, ending, and skipping so that it shows."""

import os
import signal
import sys
import time
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
NODES = Path(os.environ.get("RAVEN_BUILD", ROOT / "build")) / "devel/lib/raven_correction"
LIMIT = 30.0  # for what takes less than a second on an idle machine [s]


def until(condition, limit=LIMIT):
    end = time.monotonic() + limit
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.01)
    return True


def kill(process, how=signal.SIGKILL):
    process.send_signal(how)
    process.wait(LIMIT)


SKIPPED = {}  # name of the test: why


def skip(test, reason):
    """Ends a test that cannot run here. rosunit alone would count it as passed."""
    SKIPPED[test.id().rsplit(".", 1)[1]] = reason
    raise unittest.SkipTest(reason)


def mark_skipped():
    for name, reason in SKIPPED.items():
        print(f"SKIPPED {name}: {reason}")
    for argument in sys.argv:
        if SKIPPED and argument.startswith("--gtest_output=xml:"):
            path = argument.partition(":")[2]
            results = ElementTree.parse(path)
            for case in results.getroot().iter("testcase"):
                if case.get("name") in SKIPPED:
                    ElementTree.SubElement(case, "skipped").set("message", SKIPPED[case.get("name")])
            results.write(path)


def run_tests(name, tests):
    """main() of such a test. @param name  of its results"""
    import rosunit  # pylint: disable=import-outside-toplevel  # it reads the environment
    try:
        rosunit.unitrun("raven_correction", name, tests, sys.argv)
    finally:
        mark_skipped()
