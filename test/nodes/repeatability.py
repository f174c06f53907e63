#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""`offline experiment repeatability` in small, as a user calls it: do its numbers come from the nodes and
their bags, does the correction help, and does nothing go on running, however it ends?"""

import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import rosbag
ROOT = Path(__file__).resolve().parents[2]
OFFLINE = Path(os.environ.get("RAVEN_BUILD", ROOT / "build")) / "devel/lib/raven_correction/offline"
LIMIT = 60.0  # for what takes a few seconds on an idle machine [s]
POSES, VISITS, MOTIONS = 3, 2, 40
QUICK = "process: {criterion: likelihood, length_scales: per_feature, max_hyper_points: 300, max_exact_points: 1000}\n"


def until(condition, limit=LIMIT):
    end = time.monotonic() + limit
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.05)
    return True


def processes_of(folder):
    """Those whose command line names the folder: roslaunch passes it to the nodes' parameters and logs."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            words = (entry / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
        except OSError:
            continue
        if str(folder) in words and int(entry.name) != os.getpid():
            found.append(f"{entry.name} {words}")
    return found


class Repeatability(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="raven_correction_repeatability_test_"))
        self.output = self.folder / "output"
        self.started = []

    def tearDown(self):
        for process in self.started:
            if process.poll() is None:
                process.kill()
                process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def start(self, **changes):
        config = self.folder / "quick.yaml"
        config.write_text(QUICK, encoding="utf-8")
        options = {"poses": POSES, "visits": VISITS, "trajectories": MOTIONS, "config": config, "output": self.output,
                   "clock-rate": 5, **{name.replace("_", "-"): value for name, value in changes.items()}}
        words = [word for name, value in options.items() for word in (f"--{name}", str(value))]
        words.append("--no-play")  # of which so few motions tell nothing
        process = subprocess.Popen(  # pylint: disable=consider-using-with
            [str(OFFLINE), "experiment", "repeatability", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            text=True)
        self.started.append(process)
        return process

    def start_recording(self):
        process = self.start()
        self.assertTrue(until(lambda: list(self.output.glob("none*.bag*")) or process.poll() is not None))
        self.assertIsNone(process.poll(), "it has ended before it recorded anything")
        self.assertTrue(processes_of(self.output), "no process of the nodes can be seen")
        return process

    def expect_nothing_runs(self):
        self.assertTrue(until(lambda: not processes_of(self.output)), f"still running: {processes_of(self.output)}")

    def test_numbers_come_from_the_nodes(self):
        numbers, page = self.folder / "numbers.json", self.folder / "page.html"
        process = self.start(json=numbers, report=page, seed=4)
        text, errors = process.communicate(timeout=300)
        self.assertEqual(process.returncode, 0, errors)
        self.assertEqual(processes_of(self.output), [])
        result = json.loads(numbers.read_text(encoding="utf-8"))
        self.assertEqual(list(result["conditions"]), ["none", "full", "endpoint"])
        self.assertIn("The correction leaves", page.read_text(encoding="utf-8"))
        for name, condition in result["conditions"].items():
            for key in ("mean_abs_mm", "std_mm", "abs_std_mm", "mean_abs_deg", "std_deg"):
                self.assertEqual(len(condition[key]), 3, f"{name} {key}")
                for value in condition[key]:
                    self.assertGreater(value, 0.0, f"{name} {key}")
            self.assertEqual(condition["n"], POSES * VISITS)
            self.assertIn(name, text)
        self.assertEqual((result["poses"], result["visits"], result["seed"]), (POSES, VISITS, 4))
        self.assertEqual(result["paper"]["none"]["mean_abs_mm"], [20.3, 13.0, 22.8])
        conditions = result["conditions"]
        none = conditions["none"]["position_norm_mm"]
        self.assertGreater(none, 10.0)
        # Few motions: the demand is half of the error.
        self.assertLess(conditions["full"]["position_norm_mm"], 0.5 * none)
        self.assertLess(conditions["endpoint"]["position_norm_mm"], 0.5 * none)
        self.assertAlmostEqual(result["full_over_none"], conditions["full"]["position_norm_mm"] / none, places=9)
        # What the corrector said of the poses that it got.
        self.assertIn("passed_off", conditions["none"]["corrector"])
        self.assertNotIn("corrected", conditions["none"]["corrector"])
        self.assertGreater(conditions["full"]["corrector"]["corrected"], 100)
        self.assertGreater(conditions["endpoint"]["corrector"]["passed_between_endpoints"], 0)
        # And what the recorder has heard: the same targets each time, and another command for each.
        targets = {}
        last = {}
        for name in conditions:
            with rosbag.Bag(str(self.output / f"{name}.bag")) as bag:
                ends = [m for topic, m, _ in bag.read_messages() if topic.endswith("trajectory_event") and m.event == 1]
                commands = [m for topic, m, _ in bag.read_messages() if topic.endswith("servo_cp")
                            and not topic.endswith("desired/servo_cp")]
            self.assertEqual(len(ends), POSES * VISITS)
            targets[name] = [(m.target.position.x, m.target.position.y, m.target.position.z) for m in ends]
            last[name] = commands[-1].pose.position
        self.assertEqual(targets["none"], targets["full"])
        self.assertEqual(targets["none"], targets["endpoint"])
        self.assertEqual(len(set(targets["none"])), POSES)
        goal = targets["none"][-1]
        self.assertAlmostEqual(last["none"].x, goal[0], places=9)
        for name in ("full", "endpoint"):
            away = [last[name].x - goal[0], last[name].y - goal[1], last[name].z - goal[2]]
            self.assertGreater(sum(d * d for d in away) ** 0.5, 0.005, name)

    def test_an_interrupt_ends_everything(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(signal=number):
                process = self.start_recording()
                process.send_signal(number)
                _, errors = process.communicate(timeout=LIMIT)
                self.assertEqual(process.returncode, 1, errors)
                self.assertIn("interrupted", errors)
                self.assertEqual(processes_of(self.output), [])
                shutil.rmtree(self.output)

    def test_killed_it_leaves_nothing_behind(self):
        process = self.start_recording()
        process.kill()
        process.communicate(timeout=LIMIT)
        self.expect_nothing_runs()

    def test_bad_input_is_said_before_anything_starts(self):
        for option, part in (({"config": "/nowhere.yaml"}, "nowhere.yaml"), ({"trajectories": 1}, "at least 3"),
                             ({"clock_rate": 0}, "clock rate"), ({"json": "/nowhere/j.json"}, "/nowhere"),
                             ({"output": self.folder}, "not empty")):
            with self.subTest(option=option):
                process = self.start(**option)
                _, errors = process.communicate(timeout=LIMIT)
                self.assertEqual(process.returncode, 2, errors)
                self.assertIn(part, errors)
                self.assertFalse(self.output.exists(), "a folder is left behind")


if __name__ == "__main__":
    unittest.main()
