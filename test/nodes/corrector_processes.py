#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Faults of doc/faults.md that are ends of processes: a corrector, a trainer and a master that are killed
and started again, and model files that no corrector may start with. It has a master of its own."""

import os
import pathlib
import subprocess
import sys
import threading
import time
import xmlrpc.client

from private_master import FOLDER, ProcessTest
from processes import LIMIT, kill, until

import rosbag
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped

from raven_correction.msg import CorrectionStatus
from rigid_model import rigid_model


def shift_model(shift=0.01, name="rigid"):
    """Moves every pose along x. @param shift [m]"""
    return rigid_model(name, (shift, 0.0, 0.0))


def write_model(name, model):
    path = FOLDER / name
    with rosbag.Bag(str(path), "w") as bag:
        bag.write("correction/model", model, rospy.Time(1))
    return path


class Planner:
    """Streams a pose at 100 Hz from a thread and keeps what comes back."""

    def __init__(self):
        self.sent, self.statuses, self.commands = [], [], []
        self.publisher = rospy.Publisher("/arm/desired/servo_cp", PoseStamped, queue_size=10)
        self.subscribers = [
            rospy.Subscriber("/arm/correction/status", CorrectionStatus, self.statuses.append),
            rospy.Subscriber("/arm/servo_cp", PoseStamped, self.commands.append)]
        self.running = True
        self.thread = threading.Thread(target=self.stream)
        self.thread.start()

    def stream(self):
        message = PoseStamped()
        message.header.frame_id = "0_link"
        message.pose.orientation.w = 1.0
        while self.running:
            message.header.stamp = rospy.Time.now()
            message.pose.position.y += 1e-5
            self.publisher.publish(message)
            self.sent.append(message.header.stamp)
            time.sleep(0.01)

    def stop(self):
        self.running = False
        self.thread.join()
        self.publisher.unregister()
        for subscriber in self.subscribers:
            subscriber.unregister()

    def corrects(self):
        """Waits for a corrected pose that is answered after this call."""
        before = len(self.statuses)
        return until(lambda: any(status.code == CorrectionStatus.RIGID_ONLY
                                 for status in self.statuses[before:]))

    def answered(self, first):
        """Poses that were sent after the one of status `first` have a command and a status: most of them,
        since of those that wait the corrector takes the newest."""
        begin = self.statuses[first].header.stamp
        sent = {stamp for stamp in list(self.sent) if stamp > begin}

        def missing(messages):
            return len(sent - {message.header.stamp for message in list(messages)})

        return until(lambda: max(missing(self.statuses), missing(self.commands)) <= len(sent) // 2)

    def largest_step(self):
        """Of successive commands along the axis that the model corrects [m]."""
        places = [command.pose.position.x for command in self.commands]
        return max((abs(b - a) for a, b in zip(places, places[1:])), default=0.0)


class CorrectorProcesses(ProcessTest):
    def planner(self):
        planner = Planner()
        self.addCleanup(planner.stop)
        return planner

    def test_restart_in_the_middle_of_a_motion(self):
        model = str(write_model("restart.bag", shift_model(0.05)))
        corrector = self.start("corrector", enabled=True, model=model)
        planner = self.planner()
        self.assertTrue(planner.corrects())
        kill(corrector)
        # Whoever is gone says nothing: no command is made up, none comes from a queue.
        until(lambda: planner.publisher.get_num_connections() == 0)
        commands = len(planner.commands)
        second = self.start("corrector", enabled=True, model=model)
        self.assertTrue(planner.corrects())
        self.assertTrue(until(lambda: len(planner.commands) > commands + 20))
        stamps = [command.header.stamp for command in planner.commands[commands:]]
        self.assertEqual(stamps, sorted(set(stamps)))
        # Across the restart the command steps by no more than the correction that is not known any more,
        # and the correction comes in anew at its limited rate.
        x = [command.pose.position.x for command in planner.commands]
        self.assertAlmostEqual(x[commands - 1], 0.05, delta=1e-9)
        self.assertLessEqual(abs(x[commands] - x[commands - 1]), 0.05 + 1e-9)
        after = [command.pose.position.x for command in planner.commands[commands:]]
        self.assertLessEqual(max(abs(b - a) for a, b in zip(after, after[1:])), 0.15 * 0.1 + 1e-9)
        # Without ~enabled a corrector that is started anew passes poses through.
        kill(second)
        self.start("corrector")
        before = len(planner.statuses)
        self.assertTrue(until(lambda: any(status.code == CorrectionStatus.PASSED_OFF
                                          for status in planner.statuses[before:])))

    def test_trainer_killed(self):
        model = str(write_model("trainer.bag", shift_model()))
        trainer = self.start("trainer", model=model, data_directory=str(FOLDER),
                             model_directory=str(FOLDER))
        corrector = self.start("corrector", enabled=True)
        planner = self.planner()
        self.assertTrue(planner.corrects())
        first = len(planner.statuses)
        kill(trainer)
        self.assertTrue(until(lambda: len(planner.statuses) > first + 300))
        # Every pose goes on being corrected by the same model.
        self.assertTrue(planner.answered(first))
        self.assertEqual({(status.code, status.model) for status in planner.statuses[first:]},
                         {(CorrectionStatus.RIGID_ONLY, "rigid")})
        # A trainer that comes back is heard.
        changed = shift_model(name="after")
        self.start("trainer", model=str(write_model("after.bag", changed)), data_directory=str(FOLDER),
                   model_directory=str(FOLDER))
        self.assertTrue(until(lambda: planner.statuses[-1].model == "after"))
        self.assertIsNone(corrector.poll())

    def test_master_restarted(self):
        corrector = self.start("corrector", enabled=True,
                               model=str(write_model("master.bag", shift_model())))
        planner = self.planner()
        self.assertTrue(planner.corrects())
        proxy = xmlrpc.client.ServerProxy(os.environ["ROS_MASTER_URI"])

        def known():
            return [sorted(name for name, nodes in kind if "/arm/corrector" in nodes)
                    for kind in proxy.getSystemState("/test")[2]]

        before = known()
        said = []
        diagnostics = rospy.Subscriber("/diagnostics", DiagnosticArray, said.append)
        self.addCleanup(diagnostics.unregister)
        self.assertTrue(until(lambda: said))
        self.kill_master()
        first = len(planner.statuses)
        self.assertTrue(until(lambda: len(planner.statuses) > first + 200))
        # Diagnostics say that nobody watches the output any more.
        self.assertTrue(until(lambda: any("the master has not answered" in status.message
                                          for array in said for status in array.status)))
        self.start_master()
        # The corrector tells the new master of itself, so that others find its topics and services.
        # All that a corrector which is started at a new master tells it.
        self.assertTrue(until(lambda: known() == before), (known(), before))
        answer = subprocess.run(["rosservice", "call", "/arm/corrector/enable", "data: true"],
                                capture_output=True, text=True, check=False, timeout=60)
        self.assertIn("success: True", answer.stdout, answer.stderr)
        self.assertEqual({status.code for status in planner.statuses[first:]}, {CorrectionStatus.RIGID_ONLY})
        self.assertTrue(planner.answered(first))
        self.assertLess(planner.largest_step(), 0.015 + 1e-9)
        self.assertIsNone(corrector.poll())

    def test_realtime_priority(self):
        ask = "import os; os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(10))"
        if subprocess.run([sys.executable, "-c", ask], check=False, capture_output=True).returncode != 0:
            self.skipTest("the system allows no real-time priority here")
        corrector = self.start("corrector", realtime_priority=10)

        seen = []

        def realtime():
            seen.clear()
            for task in pathlib.Path(f"/proc/{corrector.pid}/task").iterdir():
                try:
                    if os.sched_getscheduler(int(task.name)) & ~os.SCHED_RESET_ON_FORK == os.SCHED_FIFO:
                        main = " (main)" if int(task.name) == corrector.pid else ""
                        seen.append((task / "comm").read_text().strip() + main)
                except OSError:  # it has ended meanwhile
                    pass
            return sorted(seen)

        # What handles poses, and roscpp's thread of the sockets: nothing else, also when it is at work.
        self.assertTrue(until(lambda: realtime() == ["corrector", "corrector_live"]), seen)
        planner = self.planner()
        self.assertTrue(until(lambda: len(planner.commands) > 50))
        self.assertEqual(realtime(), ["corrector", "corrector_live"])

    def expect_no_start(self, path, *reasons):
        corrector = self.start("corrector", model=str(path))
        self.assertEqual(corrector.wait(LIMIT), 1)
        said = (FOLDER / "corrector.log").read_text()
        for reason in (str(path), *reasons):
            self.assertIn(reason, said)

    def test_missing_model_file(self):
        self.expect_no_start(FOLDER / "nowhere.bag", "no such file")

    def test_truncated_model_file(self):
        path = write_model("cut.bag", shift_model())
        path.write_bytes(path.read_bytes()[:path.stat().st_size // 2])
        self.expect_no_start(path, "not a complete bag")
        path.write_bytes(b"")
        self.expect_no_start(path, "not a complete bag")
        path.write_bytes(os.urandom(5000))
        self.expect_no_start(path, "not a complete bag")

    def test_model_file_of_another_version(self):
        model = shift_model()
        model.format += 1
        path = write_model("version.bag", model)
        corrector = self.start("corrector", model=str(path))
        self.assertEqual(corrector.wait(LIMIT), 1)
        self.assertIn("has format", (FOLDER / "corrector.log").read_text())

    def test_recording_instead_of_a_model_file(self):
        path = FOLDER / "recording.bag"
        with rosbag.Bag(str(path), "w") as bag:
            bag.write("servo_cp", PoseStamped(), rospy.Time(1))
        self.expect_no_start(path, "is it a recording?")


if __name__ == "__main__":
    unittest.main()
