#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""`offline experiment debridement` in small, as a user calls it: are fragments found, picked up with the correction and
delivered, do its numbers agree with one another, and does nothing go on running?"""

import csv
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import rosunit

ROOT = Path(__file__).resolve().parents[2]
OFFLINE = Path(os.environ.get("RAVEN_BUILD", ROOT / "build")) / "devel/lib/raven_correction/offline"
LIMIT = 300.0  # for what takes less than a minute on an idle machine [s]
QUICK = "process: {criterion: likelihood, length_scales: common, max_hyper_points: 150, max_exact_points: 500}\n"


class Debridement(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="raven_correction_debridement_test_"))
        self.output = self.folder / "output"

    def tearDown(self):
        shutil.rmtree(self.folder, ignore_errors=True)

    def call(self, **changes):
        config = self.folder / "quick.yaml"
        config.write_text(QUICK, encoding="utf-8")
        options = {"fragments": 1, "arms": 1, "rehearsals": 16, "condition": "corrected", "config": config,
                   "output": self.output, "clock-rate": 4,
                   **{name.replace("_", "-"): value for name, value in changes.items()}}
        words = [word for name, value in options.items() for word in (f"--{name}", str(value))]
        return subprocess.run([str(OFFLINE), "experiment", "debridement", *words], capture_output=True, text=True,
                              timeout=LIMIT, check=False)

    def test_one_scene_is_cleared_with_the_correction(self):
        numbers, page = self.folder / "numbers.json", self.folder / "report.html"
        done = self.call(json=numbers, report=page)
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads(numbers.read_text(encoding="utf-8"))
        corrected = result["corrected"]
        self.assertGreaterEqual(corrected["fragments"], 3)
        self.assertGreater(corrected["delivered"], 0)
        delivered, fragments = corrected["delivered"], corrected["fragments"]
        self.assertAlmostEqual(corrected["seconds_per_fragment"], corrected["seconds"] / delivered, places=6)
        self.assertAlmostEqual(corrected["success_percent"], 100 * delivered / fragments, places=6)
        self.assertIsNone(corrected["smallest_distance_mm"])
        self.assertEqual(result["paper"]["speedup"], 3.8)
        self.assertIn("seconds per fragment", done.stdout)
        self.assertIn("corrected", page.read_text(encoding="utf-8"))
        with (self.output / "grasps.csv").open(encoding="utf-8") as file:
            grasps = list(csv.DictReader(file))
        outcomes = [grasp["outcome"] for grasp in grasps]
        of = {outcome: outcomes.count(outcome) for outcome in ("held", "missed", "delivered")}
        self.assertEqual(of["delivered"], corrected["delivered"])
        self.assertEqual(of["missed"], corrected["missed_grasps"])
        self.assertGreaterEqual(of["held"], of["delivered"])

    def test_bad_input_is_said_before_anything_starts(self):
        for option, part in (({"arms": 3}, "arms = 3"), ({"fragments": 0}, "fragments"),
                             ({"condition": "x"}, "x is no condition"), ({"clock_rate": 0}, "clock rate"),
                             ({"json": "/nowhere/j.json"}, "/nowhere"),
                             ({"output": self.folder}, "not empty")):
            with self.subTest(option=option):
                done = self.call(**option)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(part, done.stderr)
                self.assertFalse(self.output.exists(), "a folder is left behind")


if __name__ == "__main__":
    rosunit.unitrun("raven_correction", "debridement", Debridement, sysargs=sys.argv)
