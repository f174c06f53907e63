#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""`offline experiment debridement` in small, as a user calls it: are fragments found, picked up with the correction and
delivered, do its numbers agree with one another, and does nothing go on running?"""

import csv
import json
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
OFFLINE = Path(os.environ.get("RAVEN_BUILD", ROOT / "build")) / "devel/lib/raven_correction/offline"
LIMIT = 600.0  # for what takes a minute and a half on an idle machine [s]


class Debridement(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="raven_correction_debridement_test_"))
        self.output = self.folder / "output"

    def tearDown(self):
        shutil.rmtree(self.folder, ignore_errors=True)

    def call(self, **changes):
        options = {"fragments": 1, "arms": 1, "rehearsals": 24, "condition": "corrected",
                   "config": ROOT / "test/nodes/quick_training.yaml", "output": self.output, "clock-rate": 4,
                   **{name.replace("_", "-"): value for name, value in changes.items()}}
        words = [word for name, value in options.items() for word in (f"--{name}", str(value))]
        return subprocess.run([str(OFFLINE), "experiment", "debridement", *words], capture_output=True, text=True,
                              timeout=LIMIT, check=False)

    def test_one_scene_is_cleared_with_the_correction(self):
        numbers, page = self.folder / "numbers.json", self.folder / "report.html"
        done = self.call(json=numbers, report=page)
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads(numbers.read_text(encoding="utf-8"))
        # A jaw is open by millimetres: what is not learnt to that is not picked up.
        learnt = result["training"][0]
        self.assertLess(learnt["position_after_mm"], 0.2 * learnt["position_before_mm"], done.stdout)
        self.assertLess(learnt["trial_deviation_mm"], 5.0, done.stdout)
        corrected = result["corrected"]
        self.assertGreaterEqual(corrected["fragments"], 3)
        self.assertGreater(corrected["delivered"], 0, done.stdout)
        delivered, fragments = corrected["delivered"], corrected["fragments"]
        self.assertAlmostEqual(corrected["seconds_per_fragment"], corrected["seconds"] / delivered, places=6)
        self.assertAlmostEqual(corrected["success_percent"], 100 * delivered / fragments, places=6)
        self.assertIsNone(corrected["smallest_distance_mm"])
        self.assertEqual(result["paper"]["speedup"], 3.8)
        self.assertGreater(corrected["poses"], 100)
        self.assertGreater(corrected["poses_corrected_percent"], 95, "it worked without what it had learnt")
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
        (self.folder / "something").touch()
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
    unittest.main()
