#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the unittest cases of a file and writes what came of them as JUnit XML.

usage: run_unittest.py RESULTS.xml FILE.py

rosunit does not do: it counts skipped tests as passed and drops a subtest or a setUpClass that failed.
Exit code 1 if a test failed.
"""

import importlib.util
import sys
import unittest
from pathlib import Path

import xmlrunner


def load(path):
    """The module in a file, with the file's folder on the search path as if it had been called."""
    sys.path.insert(0, str(path.parent))
    specification = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(specification)
    sys.modules[path.stem] = module
    specification.loader.exec_module(module)
    return module


def main():
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    results = Path(sys.argv[1])
    results.parent.mkdir(parents=True, exist_ok=True)
    with results.open("wb") as file:  # first, so that earlier results are gone whatever happens
        tests = unittest.defaultTestLoader.loadTestsFromModule(load(Path(sys.argv[2]).resolve()))
        outcome = xmlrunner.XMLTestRunner(output=file, verbosity=2).run(tests)
    return 0 if outcome.wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
