#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Faults of doc/faults.md that end a recording from outside: the recorder is killed, the disk is nearly or
wholly full; and whether the tools of rosbag read what is left."""

import io
import os
import shutil
import subprocess

from private_master import FOLDER, ProcessTest
from processes import LIMIT, kill, until

import rosbag
import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseStamped, TransformStamped
from tf2_msgs.msg import TFMessage

from raven_correction.msg import RecorderStatus, TrajectoryEvent
from raven_correction.srv import StartRecording, StopRecording

CHUNK = 768 * 1024  # at which rosbag closes a chunk [byte]
RECORD = 46  # of a message in a chunk besides its content: lengths and header of bag format 2.0 [byte]
MEGABYTE = 1000000


def size_of(message):
    buffer = io.BytesIO()
    message.serialize(buffer)
    return len(buffer.getvalue())


def rosbag_tool(*arguments, **environment):
    """@return (exit code, what it said)"""
    done = subprocess.run(["rosbag", *map(str, arguments)], capture_output=True, text=True, check=False,
                          timeout=120, env={**os.environ, **environment})
    return done.returncode, done.stdout + done.stderr


def messages_in(bag, topic):
    with rosbag.Bag(str(bag)) as reader:
        return [message for _, message, _ in reader.read_messages(topics=[topic])]


class Recorder:
    """A recorder seen from outside, and somebody who publishes what it records."""

    def __init__(self, test, ns, **parameters):
        self.test = test
        self.statuses, self.diagnostics = [], []
        self.command = rospy.Publisher(f"{ns}/servo_cp", PoseStamped, queue_size=100000)
        self.mocap = rospy.Publisher(f"{ns}/mocap/measured_cp", PoseStamped, queue_size=100000)
        self.events = rospy.Publisher(f"{ns}/trajectory_event", TrajectoryEvent, queue_size=100000)
        topics = [rospy.Subscriber(f"{ns}/recorder/status", RecorderStatus, self.statuses.append),
                  rospy.Subscriber("/diagnostics", DiagnosticArray, self.diagnostics.append)]
        test.addCleanup(lambda: [topic.unregister()
                                 for topic in (*topics, self.command, self.mocap, self.events)])
        self.process = test.start("recorder", ns=ns, **parameters)
        self.start_service = rospy.ServiceProxy(f"{ns}/recorder/start", StartRecording)
        self.stop_service = rospy.ServiceProxy(f"{ns}/recorder/stop", StopRecording)
        self.start_service.wait_for_service(LIMIT)
        test.assertTrue(until(lambda: all(publisher.get_num_connections() > 0 for publisher in
                                          (self.command, self.mocap, self.events)) and self.statuses))
        self.stamp = rospy.Time.now()

    def start(self, bag):
        answer = self.start_service(bag=str(bag))
        self.test.assertTrue(answer.success, answer.message)
        return answer.bag

    def received(self, topic):
        """Messages of a topic since the recording began, as the recorder counts them."""
        status = self.statuses[-1]
        return sum(count for name, count in zip(status.topics, status.messages)
                   if name.endswith("/" + topic))

    def pose(self):
        self.stamp += rospy.Duration(0.001)
        message = PoseStamped()
        message.header.stamp, message.header.frame_id = self.stamp, "0_link"
        message.pose.position.x, message.pose.orientation.w = 0.1, 1.0
        return message

    def large(self):
        """50 KB: an event that means nothing, of a trajectory with a long name."""
        self.stamp += rospy.Duration(0.001)
        message = TrajectoryEvent()
        message.header.stamp, message.event = self.stamp, TrajectoryEvent.END
        message.trajectory = "x" * 50000
        return message

    def send_until(self, condition):
        """Publishes large messages until the recorder says so; no more than 100 wait for it."""
        sent = 0

        def step():
            nonlocal sent
            if condition():
                return True
            if sent - self.received("trajectory_event") < 100:
                for _ in range(10):
                    self.events.publish(self.large())
                sent += 10
            return False

        self.test.assertTrue(until(step, 2 * LIMIT), self.statuses[-1])

    def state_is(self, state):
        return self.statuses[-1].state == state

    def said(self, level, text):
        return any(status.level == level and text in status.message and "recorder" in status.name
                   for array in self.diagnostics for status in array.status)


class RecorderProcesses(ProcessTest):
    def small_disk(self, megabytes):
        """A file system of its own, with so much room. Skips where nothing may be mounted."""
        place = FOLDER / f"disk_{self.id().rsplit('.', 1)[-1]}"
        place.mkdir()
        mount = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={megabytes * MEGABYTE}",
                                "raven_correction_test", str(place)],
                               capture_output=True, text=True, check=False)
        if mount.returncode != 0:
            self.skipTest(f"a small disk cannot be mounted here: {mount.stderr.strip()}; "
                          "SessionWriter.SurvivesADiskThatFailsAndKeepsWhatItHas does without")
        self.addCleanup(lambda: subprocess.run(["umount", "-l", str(place)], check=True))
        return place

    def test_killed_recorder_loses_at_most_the_last_chunk(self):
        recorder = Recorder(self, "/killed", directory=str(FOLDER / "killed"), min_free_mb=1.0)
        bag = recorder.start("session")
        count = 25000  # of some 170 byte: five chunks
        for _ in range(count):
            recorder.command.publish(recorder.pose())
        self.assertTrue(until(lambda: recorder.received("servo_cp") == count), recorder.statuses[-1])
        # What was received before a status is handed to the bag by the next one.
        before = len(recorder.statuses)
        self.assertTrue(until(lambda: len(recorder.statuses) > before + 1))
        self.assertEqual(recorder.statuses[-1].dropped, 0)
        kill(recorder.process)

        killed = bag + ".active"
        self.assertTrue(os.path.exists(killed))
        code, said = rosbag_tool("reindex", "-q", "-f", killed)
        self.assertEqual(code, 0, said)
        kept = messages_in(killed, "servo_cp")
        lost = count - len(kept)
        self.assertLessEqual(lost, CHUNK // (RECORD + size_of(recorder.pose())) + 1)
        self.assertGreater(lost, 0, "nothing was in memory: this shows nothing")
        stamps = [message.header.stamp for message in kept]
        self.assertEqual(stamps, sorted(set(stamps)))
        code, said = rosbag_tool("info", killed)
        self.assertEqual(code, 0, said)

        # A recorder that is started again does not write over it.
        again = Recorder(self, "/killed", directory=str(FOLDER / "killed"), min_free_mb=1.0)
        self.assertFalse(again.start_service(bag="session").success)
        again.start("another")

    def test_disk_nearly_full(self):
        place = self.small_disk(24)
        recorder = Recorder(self, "/nearly", directory=str(place), min_free_mb=8.0)
        bag = recorder.start("session")
        recorder.send_until(lambda: recorder.state_is(RecorderStatus.STOPPED_DISK_FULL))
        status = recorder.statuses[-1]
        self.assertIn("min_free_mb", status.message)
        self.assertTrue(until(lambda: recorder.said(DiagnosticStatus.ERROR, "min_free_mb")))
        # The bag was closed in good order, with all that was written before.
        kept = messages_in(bag, "trajectory_event")
        self.assertGreater(len(kept), 100)
        stamps = [message.header.stamp for message in kept]
        self.assertEqual([round((b - a).to_sec(), 6) for a, b in zip(stamps, stamps[1:])],
                         [0.001] * (len(stamps) - 1))  # none is missing in between
        self.assertEqual(rosbag_tool("check", bag)[0], 0)
        stopped = recorder.stop_service()
        self.assertFalse(stopped.success)
        self.assertIn("min_free_mb", stopped.message)
        self.assertEqual(list(stopped.bags), [bag])
        # It says so when it is asked to begin anew, and begins once there is room.
        refused = recorder.start_service(bag="next")
        self.assertFalse(refused.success)
        self.assertIn("MB free", refused.message)
        os.remove(bag)
        recorder.start("next")
        self.assertTrue(recorder.stop_service().success)
        self.assertIsNone(recorder.process.poll())

    def test_disk_without_room_for_a_byte(self):
        place = self.small_disk(8)
        recorder = Recorder(self, "/full", directory=str(place), min_free_mb=0.0)
        bag = recorder.start("session")
        recorder.send_until(lambda: recorder.state_is(RecorderStatus.STOPPED_ERROR))
        self.assertIn("rosbag reindex", recorder.statuses[-1].message)
        self.assertTrue(until(lambda: recorder.said(DiagnosticStatus.ERROR, "rosbag reindex")))
        stopped = recorder.stop_service()
        self.assertFalse(stopped.success)
        self.assertGreater(recorder.statuses[-1].dropped, 0)
        # What was written is there, and readable where there is room for the index.
        roomy = FOLDER / "rescued.bag"
        shutil.copy(bag + ".active", roomy)
        code, said = rosbag_tool("reindex", "-q", "-f", roomy)
        self.assertEqual(code, 0, said)
        kept = messages_in(roomy, "trajectory_event")
        content = size_of(recorder.large()) + RECORD
        self.assertGreaterEqual(len(kept) * content, 8 * MEGABYTE - 2 * CHUNK)
        # The node goes on: another recording, on a disk with room.
        recorder.start(FOLDER / "elsewhere.bag")
        recorder.command.publish(recorder.pose())
        self.assertTrue(until(lambda: recorder.received("servo_cp") == 1))
        self.assertTrue(recorder.stop_service().success)
        self.assertEqual(len(messages_in(FOLDER / "elsewhere.bag", "servo_cp")), 1)

    def test_bag_is_read_by_check_info_and_play(self):
        recorder = Recorder(self, "/played", directory=str(FOLDER / "played"), min_free_mb=1.0)
        transforms = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
        self.addCleanup(transforms.unregister)
        registration = TransformStamped()
        registration.header.frame_id, registration.child_frame_id = "0_link", "mocap"
        registration.transform.rotation.w = 1.0
        transforms.publish(TFMessage([registration]))
        bag = recorder.start("session")
        count = 200
        for _ in range(count):
            recorder.command.publish(recorder.pose())
            seen = recorder.pose()
            seen.header.frame_id = "mocap"
            recorder.mocap.publish(seen)
        self.assertTrue(until(lambda: recorder.received("servo_cp") == count and
                              recorder.received("mocap/measured_cp") == count))
        self.assertTrue(recorder.stop_service().success)

        code, said = rosbag_tool("check", bag)
        self.assertEqual(code, 0, said)
        code, said = rosbag_tool("info", bag)
        self.assertEqual(code, 0, said)
        for line in (f"servo_cp {count} msgs", f"mocap/measured_cp {count} msgs", "recorder/parameters 1 msg"):
            self.assertIn(line, " ".join(said.split()))
        heard = {"servo_cp": [], "mocap/measured_cp": []}
        for topic, messages in heard.items():
            subscriber = rospy.Subscriber(f"/replay/{topic}", PoseStamped, messages.append)
            self.addCleanup(subscriber.unregister)
        code, said = rosbag_tool("play", "--quiet", "--wait-for-subscribers", bag, "--topics", *heard,
                                 ROS_NAMESPACE="/replay")
        self.assertEqual(code, 0, said)
        self.assertTrue(until(lambda: all(len(messages) == count for messages in heard.values())),
                        {topic: len(messages) for topic, messages in heard.items()})
        self.assertEqual([message.header.stamp for message in heard["servo_cp"]],
                         [message.header.stamp for message in messages_in(bag, "servo_cp")])


if __name__ == "__main__":
    unittest.main()
