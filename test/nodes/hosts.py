#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A lab on three hosts, as network namespaces: the robot's with simulator, planner and corrector, the
cameras' with motion capture and recorder, and a workstation with master and trainer. What happens when
the workstation cannot be reached, and when the clock of the cameras is off?"""

import copy
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import unittest
import xmlrpc.client
from pathlib import Path

from network import Network
from processes import LIMIT, NODES, ROOT, kill, until

PORT = 11311
ARM = "/arm"
CLOCK_ERROR = 0.05  # [s]
DELAY_WINDOW = 8.0  # of the recorder [s]

FOLDER = Path(tempfile.mkdtemp(prefix="raven_correction_hosts_"))
NETWORK, WHY_NOT = None, ""
try:
    NETWORK = Network("robot", "cameras", "workstation")
    # This test is the observer on the robot's host.
    NETWORK.enter("robot")
    os.environ["ROS_IP"] = NETWORK.address("robot")
    os.environ["ROS_MASTER_URI"] = f"http://{NETWORK.address('workstation')}:{PORT}"
except subprocess.CalledProcessError as problem:
    WHY_NOT = f"hosts of their own cannot be made here: {' '.join(problem.cmd)}: {problem.stderr.strip()}"
except OSError as problem:
    WHY_NOT = f"hosts of their own cannot be made here: {problem}"
os.environ["ROS_LOG_DIR"] = str(FOLDER / "log")

# These read the environment.
import rosbag  # noqa: E402 pylint: disable=wrong-import-position
import rospy  # noqa: E402 pylint: disable=wrong-import-position
import yaml  # noqa: E402 pylint: disable=wrong-import-position
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus  # noqa: E402 pylint: disable=wrong-import-position
from geometry_msgs.msg import PoseStamped  # noqa: E402 pylint: disable=wrong-import-position
from std_msgs.msg import Float64  # noqa: E402 pylint: disable=wrong-import-position
from std_srvs.srv import Trigger  # noqa: E402 pylint: disable=wrong-import-position

from raven_correction.msg import CorrectionStatus, RecorderStatus  # noqa: E402 pylint: disable=wrong-import-position
from raven_correction.srv import LoadModel, RunPlanner, StartRecording, StopRecording  # noqa: E402 pylint: disable=wrong-import-position

CORRECTED = {CorrectionStatus.CORRECTED, CorrectionStatus.CORRECTED_FADED, CorrectionStatus.CORRECTED_LIMITED}


def offline(*arguments):
    subprocess.run([str(NODES / "offline"), *map(str, arguments)], check=True, capture_output=True,
                   timeout=4 * LIMIT)


def train_model():
    """Of the robot that is simulated. @return the model"""
    offline("simulate", "--simulation", ROOT / "config/simulation/demo.yaml", "--trajectories", "25", "--seed",
            "5", "-o", FOLDER / "session.bag")
    offline("train", FOLDER / "session.bag", "--config", ROOT / "test/nodes/quick_training.yaml", "-o",
            FOLDER / "model.bag")
    with rosbag.Bag(str(FOLDER / "model.bag")) as bag:
        for _, model, _ in bag.read_messages():
            return model


def write_model(model, name):
    with rosbag.Bag(str(FOLDER / name), "w") as bag:
        bag.write("correction/model", model, model.header.stamp)
    return str(FOLDER / name)


def master_answers():
    try:
        return xmlrpc.client.ServerProxy(os.environ["ROS_MASTER_URI"]).getPid("/test")[0] == 1
    except OSError:
        return False


class Observer:
    """What is said on the robot's host, in the order in which it comes."""

    def __init__(self):
        self.desired, self.commands, self.statuses, self.recorder, self.diagnostics = [], [], [], [], []
        self.subscribers = [
            rospy.Subscriber(f"{ARM}/desired/servo_cp", PoseStamped, self.desired.append),
            rospy.Subscriber(f"{ARM}/servo_cp", PoseStamped, self.commands.append),
            rospy.Subscriber(f"{ARM}/correction/status", CorrectionStatus, self.statuses.append),
            rospy.Subscriber(f"{ARM}/recorder/status", RecorderStatus, self.recorder.append),
            rospy.Subscriber("/diagnostics", DiagnosticArray,
                             lambda array: self.diagnostics.extend(array.status))]

    def stop(self):
        for subscriber in self.subscribers:
            subscriber.unregister()

    def says(self, node, condition):
        """Waits for diagnostics of a node that come after this call and of which the condition holds."""
        before = len(self.diagnostics)
        return until(lambda: any(node in status.name and condition(status)
                                 for status in self.diagnostics[before:]), 2 * LIMIT)

    def recorded(self, topic):
        status = self.recorder[-1]
        return sum(count for name, count in zip(status.topics, status.messages) if name == f"{ARM}/{topic}")


class Hosts(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(128 + number))  # so that hosts are removed
        if WHY_NOT:
            return
        cls.model = train_model()
        cls.master = cls.run_on("workstation", "rosmaster", "--core", "-p", str(PORT))
        assert until(master_answers), "the master does not start"
        rospy.init_node("observer", disable_signals=True)

    @classmethod
    def tearDownClass(cls):
        if not WHY_NOT:
            rospy.signal_shutdown("done")
            kill(cls.master)
            NETWORK.remove()
        shutil.rmtree(FOLDER, ignore_errors=True)

    @staticmethod
    def run_on(host, *command):
        with open(FOLDER / f"{Path(command[0]).name}.log", "w") as log:  # the process keeps it open
            return subprocess.Popen([*NETWORK.on(host), *command], stdout=log, stderr=subprocess.STDOUT,
                                    env={**os.environ, "ROS_IP": NETWORK.address(host)})

    def start(self, host, node, *remappings, file=None, **parameters):
        path = f"{ARM}/{node}"
        if rospy.has_param(path):
            rospy.delete_param(path)
        if file:
            parameters = {**yaml.safe_load((ROOT / "config" / file).read_text()), **parameters}
        for name, value in parameters.items():
            rospy.set_param(f"{path}/{name}", value)
        process = self.run_on(host, str(NODES / node), f"__ns:={ARM}", f"__name:={node}", *remappings)
        self.addCleanup(lambda: process.poll() is None and kill(process))
        return process

    def setUp(self):
        if WHY_NOT:
            self.skipTest(WHY_NOT)
        self.observer = Observer()
        self.addCleanup(self.observer.stop)
        self.start("robot", "simulator", "mocap/measured_cp:=cameras/measured_cp", file="simulator.yaml",
                   simulation=str(ROOT / "config/simulation/demo.yaml"))
        self.corrector = self.start("robot", "corrector", file="corrector.yaml", enabled=True)
        self.start("robot", "planner", file="planner.yaml",
                   robot=str(ROOT / "config/robots/raven2_left.yaml"))
        cameras = self.run_on("cameras", sys.executable, str(Path(__file__).with_name("camera_host.py")),
                              f"__ns:={ARM}")
        self.addCleanup(lambda: kill(cameras))
        self.start("cameras", "recorder", directory=str(FOLDER / self.id().rsplit(".", 1)[1]),
                   min_free_mb=10.0, delay_window=DELAY_WINDOW)
        self.start("workstation", "trainer", model=str(FOLDER / "model.bag"), data_directory=str(FOLDER),
                   model_directory=str(FOLDER))
        for service in ("planner/run", "recorder/start", "trainer/load", "corrector/enable"):
            rospy.wait_for_service(f"{ARM}/{service}", LIMIT)
        # All that must have found one another before a link may be cut.
        self.assertTrue(until(lambda: self.observer.recorder and self.observer.diagnostics))
        self.start_moving()
        self.assertTrue(until(lambda: self.corrects(self.model.id), 2 * LIMIT), self.observer.statuses[-1:])

    def start_moving(self):
        run = rospy.ServiceProxy(f"{ARM}/planner/run", RunPlanner)
        thread = threading.Thread(target=lambda: run(trajectories=1000, seed=3))

        def stop():
            NETWORK.join("workstation")  # who stops must find the planner
            self.assertTrue(until(master_answers))
            rospy.ServiceProxy(f"{ARM}/planner/stop", Trigger)()
            thread.join()

        thread.start()
        self.addCleanup(stop)

    def corrects(self, model):
        return any(status.model == model and status.code == CorrectionStatus.CORRECTED
                   for status in self.observer.statuses[-20:])

    def test_link_to_the_workstation_is_cut_and_comes_back(self):
        seen = self.observer
        answer = rospy.ServiceProxy(f"{ARM}/recorder/start", StartRecording)(bag="cut")
        self.assertTrue(answer.success, answer.message)
        first = len(seen.commands)
        self.assertTrue(until(lambda: len(seen.commands) > first + 50))

        NETWORK.cut("workstation")
        first_desired, first_status = len(seen.desired), len(seen.statuses)
        recorded = seen.recorded("servo_cp")
        # The state says so, and for ten seconds and more nothing else happens: every pose is answered,
        # corrected by the same model, forwarded, acted upon, seen and recorded.
        self.assertTrue(seen.says("corrector", lambda status: status.level == DiagnosticStatus.WARN and
                                  "the master has not answered" in status.message))
        self.assertTrue(until(lambda: len(seen.statuses) > first_status + 500))
        asked = {message.header.stamp for message in seen.desired[first_desired:first_desired + 450]}
        # All but a few: of poses that wait the corrector takes the newest.
        for answers in (seen.statuses, seen.commands):
            self.assertTrue(until(lambda answers=answers: len(
                asked - {message.header.stamp for message in answers}) <= len(asked) // 20))
        during = [status for status in seen.statuses[first_status:] if status.header.stamp in asked]
        self.assertLessEqual({status.code for status in during}, CORRECTED)
        self.assertEqual({status.model for status in during}, {self.model.id})
        self.assertTrue(until(lambda: seen.recorded("servo_cp") > recorded + 400))
        self.assertEqual(seen.recorder[-1].dropped, 0)

        NETWORK.join("workstation")
        self.assertTrue(seen.says("corrector", lambda status: "the master has not answered" not in
                                  status.message and "poses" in status.message))
        # The trainer can be called again, and its next model arrives.
        after = copy.deepcopy(self.model)
        after.id = "after the cut"
        loaded = rospy.ServiceProxy(f"{ARM}/trainer/load", LoadModel)(file=write_model(after, "after.bag"))
        self.assertTrue(loaded.success, loaded.message)
        self.assertTrue(until(lambda: self.corrects("after the cut")))
        last = seen.commands[-1].header.stamp
        self.assertTrue(until(lambda: seen.recorder[-1].header.stamp > last + rospy.Duration(2)))
        stopped = rospy.ServiceProxy(f"{ARM}/recorder/stop", StopRecording)()
        self.assertTrue(stopped.success, stopped.message)
        # Between the first and the last command in the bag none is missing of those that were sent.
        with rosbag.Bag(stopped.bags[0]) as bag:
            kept = [message.header.stamp for _, message, _ in bag.read_messages(topics=["servo_cp"])]
        sent = {message.header.stamp for message in seen.commands if kept[0] <= message.header.stamp <= last}
        self.assertGreater(len(sent), 500)
        self.assertEqual(sent - set(kept), set())
        self.assertIsNone(self.corrector.poll())

    def test_clock_of_the_cameras_is_off(self):
        clock = rospy.Publisher(f"{ARM}/clock_error", Float64, queue_size=1, latch=True)
        self.addCleanup(clock.unregister)
        delays = []

        def has_delay(status):
            values = {value.key: value.value for value in status.values}
            if "delay of motion capture [s]" in values:
                delays.append(float(values["delay of motion capture [s]"]))
            return "delay of motion capture [s]" in values

        def warns(status):
            return status.level == DiagnosticStatus.WARN and "behind the commands" in status.message

        self.assertTrue(self.observer.says("recorder", lambda status: has_delay(status) and not warns(status)),
                        self.observer.diagnostics[-5:])
        right = delays[-1]
        self.assertAlmostEqual(right, self.model.speed_delay, delta=0.02)
        clock.publish(CLOCK_ERROR)
        self.assertTrue(self.observer.says(
            "recorder", lambda status: has_delay(status) and warns(status) and
            abs(delays[-1] - right - CLOCK_ERROR) < 0.02), delays)
        self.assertIn(f"in what model {self.model.id} was trained on", self.observer.recorder[-1].message)
        clock.publish(0.0)
        self.assertTrue(self.observer.says("recorder", lambda status: has_delay(status) and not warns(status)),
                        delays)


if __name__ == "__main__":
    unittest.main()
