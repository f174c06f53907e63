#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""One corrector for both arms of a Berkeley stack, driven with messages that genpy makes from the
definitions of raven_2_msgs: an independent serialisation of what our adapter reads and rewrites."""

import math
import random
import shutil
import sys
import threading
import unittest

import genpy.dynamic
import rosbag
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Pose

from raven_correction.msg import CorrectionModel, CorrectionStatus, RecorderStatus
from raven_correction.srv import SetMode, StartRecording, StopRecording
from rigid_model import rigid_model

# raven_2_msgs/msg of rll/raven_2: facts of its interface, written down independently of the adapter.
DEFINITIONS = [
    ("raven_2_msgs/RavenCommand", """
Header header
string source
bool pedal_down
uint8 controller
string[] arm_names
ArmCommand[] arms
"""),
    ("std_msgs/Header", """
uint32 seq
time stamp
string frame_id
"""),
    ("raven_2_msgs/ArmCommand", """
bool active
ToolCommand tool_command
uint16[] joint_types
JointCommand[] joint_commands
"""),
    ("raven_2_msgs/ToolCommand", """
uint8 pose_option
uint8 POSE_OFF=0
uint8 POSE_ABSOLUTE=5
uint8 POSE_RELATIVE=15
uint8 POSE_POS_REL_ORI_ABS=7
uint8 POSE_POS_ABS_ORI_REL=13
uint8 POSE_POS_ABS_ORI_OFF=1
uint8 POSE_POS_OFF_ORI_ABS=4
uint8 POSE_POS_REL_ORI_OFF=3
uint8 POSE_POS_OFF_ORI_REL=12
uint8 POSE_OPTION_FLAG_POSITION_ENABLED=1
uint8 POSE_OPTION_FLAG_POSITION_RELATIVE=2
uint8 POSE_OPTION_FLAG_ORIENTATION_ENABLED=4
uint8 POSE_OPTION_FLAG_ORIENTATION_RELATIVE=8
string POSE_OPTION_STRINGS = """ + ",".join(
        {0: "OFF", 1: "POS_ABS_ORI_OFF", 3: "POS_REL_ORI_OFF", 4: "POS_OFF_ORI_ABS", 5: "ABSOLUTE",
         7: "POS_REL_ORI_ABS", 12: "POS_OFF_ORI_REL", 13: "POS_ABS_ORI_REL", 15: "RELATIVE"}.get(i, f"ERR{i}")
        for i in range(16)) + """
geometry_msgs/Pose pose
uint8 grasp_option
uint8 GRASP_OFF=0
uint8 GRASP_SET_NORMALIZED=1
uint8 GRASP_INCREMENT=2
uint8 GRASP_INCREMENT_SIGN=3
uint8 GRASP_SET_ANGLE=4
string GRASP_OPTION_STRINGS = OFF,SET_NORMALIZED,INCREMENT,INCREMENT_SIGN,SET_ANGLE
float32 grasp
"""),
    ("geometry_msgs/Pose", "\nPoint position\nQuaternion orientation\n"),
    ("geometry_msgs/Point", "\nfloat64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Quaternion", "\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"),
    ("raven_2_msgs/JointCommand", """
uint8 command_type
float32 value
uint8 COMMAND_TYPE_NONE=0
uint8 COMMAND_TYPE_POSITION=1
uint8 COMMAND_TYPE_VELOCITY=2
uint8 COMMAND_TYPE_MOTOR_POSITION=3
uint8 COMMAND_TYPE_MOTOR_VELOCITY=4
uint8 COMMAND_TYPE_TORQUE=5
string COMMAND_TYPE_STRINGS = NONE,POSITION,VELOCITY,MOTOR_POSITION,MOTOR_VELOCITY,TORQUE
"""),
]
PUBLISHED_MD5 = "02b34bd728d23aaf997e47b9c67c0d8e"  # of the package as its authors ship it


def full_text():
    separator = "=" * 80 + "\n"
    first, *others = DEFINITIONS
    return first[1] + "".join(f"{separator}MSG: {name}\n{text}" for name, text in others)


TYPES = genpy.dynamic.generate_dynamic("raven_2_msgs/RavenCommand", full_text())
RavenCommand, ArmCommand, JointCommand = (
    TYPES[f"raven_2_msgs/{name}"] for name in ("RavenCommand", "ArmCommand", "JointCommand"))
OFF, ABSOLUTE, RELATIVE, POSITION_ONLY, ORIENTATION_ONLY = 0, 5, 15, 1, 4
SHIFT = {"L": (0.010, -0.004, 0.002), "R": (-0.006, 0.008, 0.001)}  # what the models add [m]
TURN = math.pi / 8  # and how much they turn, about z [rad]
PASSED_OFF, NOT_ABSOLUTE, INACTIVE = (CorrectionStatus.PASSED_OFF, CorrectionStatus.PASSED_NOT_ABSOLUTE,
                                      CorrectionStatus.PASSED_INACTIVE)


def model_of(arm):
    return rigid_model(f"rigid_{arm}", SHIFT[arm], TURN, {"L": "raven2_left", "R": "raven2_right"}[arm])


def random_arm(generator, option=ABSOLUTE, active=True):
    arm = ArmCommand()
    arm.active = active
    tool = arm.tool_command
    tool.pose_option = option
    quaternion = [generator.gauss(0, 1) for _ in range(4)]
    norm = math.sqrt(sum(value * value for value in quaternion))
    tool.pose.orientation.x, tool.pose.orientation.y, tool.pose.orientation.z, tool.pose.orientation.w = (
        value / norm for value in quaternion)
    tool.pose.position.x, tool.pose.position.y, tool.pose.position.z = (
        generator.uniform(-0.1, 0.1) for _ in range(3))
    tool.grasp_option = generator.randrange(5)
    tool.grasp = generator.uniform(-1, 1)
    arm.joint_types = [generator.randrange(1 << 16) for _ in range(generator.randrange(5))]
    for _ in range(generator.randrange(5)):
        joint = JointCommand()
        joint.command_type, joint.value = generator.randrange(6), generator.gauss(0, 1)
        arm.joint_commands.append(joint)
    return arm


def next_stamp():
    """0.1 s after the last one: all of a correction may come in within one command."""
    next_stamp.last = max(next_stamp.last + rospy.Duration.from_sec(0.1), rospy.Time.now())
    return next_stamp.last


next_stamp.last = rospy.Time(0)


def command(arms, pedal_down=True, frame="0_link", generator=random):
    message = RavenCommand()
    message.header.stamp = next_stamp()
    message.header.frame_id = frame
    message.source = "planner" * generator.randrange(4)
    message.pedal_down = pedal_down
    message.controller = generator.randrange(9)
    message.arm_names = [name for name, _ in arms]
    message.arms = [arm for _, arm in arms]
    return message


def serialised(message):
    """The bytes as genpy writes them."""
    buffer = bytearray()

    class Sink:
        @staticmethod
        def write(part):
            buffer.extend(part)

    message.serialize(Sink)
    return bytes(buffer)


def corrected(pose, arm):
    """Rigid step times pose, written out."""
    c, s = math.cos(TURN), math.sin(TURN)
    ch, sh = math.cos(TURN / 2), math.sin(TURN / 2)
    p, q = pose.position, pose.orientation
    result = Pose()
    result.position.x = SHIFT[arm][0] + c * p.x - s * p.y
    result.position.y = SHIFT[arm][1] + s * p.x + c * p.y
    result.position.z = SHIFT[arm][2] + p.z
    result.orientation.w = ch * q.w - sh * q.z
    result.orientation.x = ch * q.x - sh * q.y
    result.orientation.y = ch * q.y + sh * q.x
    result.orientation.z = ch * q.z + sh * q.w
    return result


class RavenCommandTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.changed = threading.Condition()
        cls.received, cls.statuses, cls.header = [], {"L": [], "R": []}, {}
        cls.publisher = rospy.Publisher("/raven/desired/servo_cp", RavenCommand, queue_size=100)
        rospy.Subscriber("/raven/servo_cp", rospy.AnyMsg, cls.note, ("command", None), queue_size=1000)
        cls.models = {}
        for arm, side in (("L", "left"), ("R", "right")):
            rospy.Subscriber(f"/raven/{side}/correction/status", CorrectionStatus, cls.note,
                             ("status", arm), queue_size=1000)
            cls.models[arm] = rospy.Publisher(f"/raven/{side}/correction/model", CorrectionModel,
                                              queue_size=1, latch=True)
            cls.models[arm].publish(model_of(arm))
        rospy.wait_for_service("/raven/corrector/set_mode", 30)
        cls.set_mode = staticmethod(rospy.ServiceProxy("/raven/corrector/set_mode", SetMode))
        cls.wait(lambda: cls.publisher.get_num_connections() >= 1)
        # Until the models have arrived and every connection stands.
        cls.set_mode(mode="full")
        deadline = rospy.get_time() + 30
        while rospy.get_time() < deadline:
            cls.exchange(command([("L", random_arm(random)), ("R", random_arm(random))]), strict=False)
            if all(cls.statuses[arm] and cls.statuses[arm][-1].model == f"rigid_{arm}" for arm in "LR") \
                    and cls.received:
                return
        raise AssertionError("the corrector did not take the models")

    @classmethod
    def note(cls, message, what):
        with cls.changed:
            if what[0] == "command":
                cls.received.append(bytes(message._buff))  # pylint: disable=protected-access
                cls.header = message._connection_header  # pylint: disable=protected-access
            else:
                cls.statuses[what[1]].append(message)
            cls.changed.notify_all()

    @classmethod
    def wait(cls, condition, limit=20):
        with cls.changed:
            end = rospy.get_time() + limit
            while not condition():
                if rospy.get_time() > end:
                    return False
                cls.changed.wait(0.05)
            return True

    @classmethod
    def exchange(cls, message, strict=True, forwarded=True):
        """Sends a command; its bytes, those that were forwarded (or None), and the codes by arm."""
        named = [name for name in message.arm_names if name in cls.statuses]
        with cls.changed:
            commands, before = len(cls.received), {arm: len(cls.statuses[arm]) for arm in named}
        cls.publisher.publish(message)
        answered = cls.wait(lambda: all(len(cls.statuses[arm]) > before[arm] for arm in named) and
                            (len(cls.received) > commands or not forwarded), 20 if strict else 0.3)
        if strict and not answered:
            raise AssertionError("no answer")
        with cls.changed:
            result = cls.received[-1] if len(cls.received) > commands else None
            return serialised(message), result, {arm: cls.statuses[arm][-1].code for arm in named
                                                 if cls.statuses[arm]}

    def setUp(self):
        self.set_mode(mode="full")
        self.generator = random.Random(7)

    def arms(self, left=ABSOLUTE, right=ABSOLUTE, active=(True, True)):
        return [("L", random_arm(self.generator, left, active[0])),
                ("R", random_arm(self.generator, right, active[1]))]

    def expect_only(self, message, sent, got, parts):
        """Bytes outside of the named (arm, part) fields are equal; inside they hold the correction."""
        self.assertEqual(len(sent), len(got))
        decoded = RavenCommand().deserialize(got)
        expected = RavenCommand().deserialize(sent)
        for arm, part in parts:
            index = message.arm_names.index(arm)
            original = message.arms[index].tool_command.pose
            wanted = getattr(corrected(original, arm), part)
            found = getattr(decoded.arms[index].tool_command.pose, part)
            for axis in found.__slots__:
                self.assertAlmostEqual(getattr(found, axis), getattr(wanted, axis), delta=1e-12)
            self.assertNotEqual(found, getattr(original, part))
            # What is left must be the original, bit for bit.
            setattr(expected.arms[index].tool_command.pose, part, found)
        self.assertEqual(serialised(expected), got)

    def test_md5_and_definition_are_those_of_genpy(self):
        self.assertEqual(RavenCommand._md5sum, PUBLISHED_MD5)  # pylint: disable=protected-access
        self.exchange(command(self.arms()))
        self.assertEqual(self.header["md5sum"], PUBLISHED_MD5)
        self.assertEqual(self.header["type"], "raven_2_msgs/RavenCommand")
        ours = genpy.dynamic.generate_dynamic("raven_2_msgs/RavenCommand", self.header["message_definition"])
        self.assertEqual(ours["raven_2_msgs/RavenCommand"]._md5sum,  # pylint: disable=protected-access
                         PUBLISHED_MD5)

    def test_off_forwards_the_same_bytes(self):
        self.set_mode(mode="off")
        # Once, to take the correction back.
        self.exchange(command(self.arms()))
        for _ in range(50):
            sent, got, codes = self.exchange(command(self.arms(), generator=self.generator))
            self.assertEqual(sent, got)
            self.assertEqual(codes, {"L": PASSED_OFF, "R": PASSED_OFF})

    def test_on_changes_the_poses_and_nothing_else(self):
        for _ in range(50):
            message = command(self.arms(), generator=self.generator)
            sent, got, codes = self.exchange(message)
            self.assertEqual(codes, {"L": CorrectionStatus.RIGID_ONLY, "R": CorrectionStatus.RIGID_ONLY})
            self.expect_only(message, sent, got, [(arm, part) for arm in "LR"
                                                  for part in ("position", "orientation")])

    def test_only_the_named_arm_changes(self):
        for arms, changed in (((True, False), "L"), ((False, True), "R")):
            message = command(self.arms(active=arms))
            sent, got, codes = self.exchange(message)
            self.assertEqual(codes[{"L": "R", "R": "L"}[changed]], INACTIVE)
            self.expect_only(message, sent, got, [(changed, "position"), (changed, "orientation")])
        message = command([("R", random_arm(self.generator))])  # alone in its message
        sent, got, _ = self.exchange(message)
        self.expect_only(message, sent, got, [("R", "position"), ("R", "orientation")])

    def test_arm_of_another_name_is_left_alone(self):
        sent, got, _ = self.exchange(command([("third", random_arm(self.generator))]))
        self.assertEqual(sent, got)

    def test_pose_options(self):
        # A part alone is corrected with the other part as it was asked for last, and written alone.
        left = random_arm(self.generator)
        self.exchange(command([("L", left)]))
        pose = left.tool_command.pose
        left.tool_command.pose_option = POSITION_ONLY
        kept = pose.orientation.x
        pose.orientation.x = float("nan")  # not asked for: may hold anything
        message = command([("L", left)])
        sent, got, codes = self.exchange(message)
        self.assertEqual(codes["L"], CorrectionStatus.RIGID_ONLY)
        self.expect_only(message, sent, got, [("L", "position")])
        pose.orientation.x = kept
        left.tool_command.pose_option = ORIENTATION_ONLY
        message = command([("L", left)])
        sent, got, codes = self.exchange(message)
        self.assertEqual(codes["L"], CorrectionStatus.RIGID_ONLY)
        self.expect_only(message, sent, got, [("L", "orientation")])
        # Increments, and parts whose other part is not known after them, are forwarded unchanged.
        for option in (RELATIVE, 7, 13, 3, 12, POSITION_ONLY, ORIENTATION_ONLY):
            if option == ORIENTATION_ONLY:
                self.exchange(command([("L", random_arm(self.generator, RELATIVE))]))
            sent, got, codes = self.exchange(command([("L", random_arm(self.generator, option))]))
            self.assertEqual(sent, got, option)
            self.assertEqual(codes["L"], NOT_ABSOLUTE, option)
        sent, got, codes = self.exchange(command([("L", random_arm(self.generator, OFF))]))
        self.assertEqual((sent, codes["L"]), (got, INACTIVE))

    def test_pedal_up_and_inactive_arms_pass_even_without_stamp_or_frame(self):
        message = command(self.arms(), pedal_down=False, frame="")
        message.header.stamp = rospy.Time(0)
        message.arms[0].tool_command.pose.position.x = float("nan")
        sent, got, codes = self.exchange(message)
        self.assertEqual(sent, got)
        self.assertEqual(codes, {"L": INACTIVE, "R": INACTIVE})

    def expect_refused(self, message, codes):
        with self.changed:
            before = len(self.received)
        self.assertEqual(self.exchange(message, forwarded=False)[2], codes)
        self.exchange(command(self.arms()))
        with self.changed:
            self.assertEqual(len(self.received), before + 1)

    def test_fault_of_one_arm_refuses_the_whole_command(self):
        message = command(self.arms())
        message.arms[1].tool_command.pose.position.y = float("nan")
        self.expect_refused(message, {"L": CorrectionStatus.REFUSED_WITH_OTHER_ARM,
                                      "R": CorrectionStatus.REFUSED_NOT_FINITE})
        # Nor does a broken increment get through.
        message = command([("L", random_arm(self.generator, RELATIVE))])
        message.arms[0].tool_command.pose.orientation.w = 7.0
        self.expect_refused(message, {"L": CorrectionStatus.REFUSED_NOT_UNIT})

    def test_repeated_increment_is_refused(self):
        message = command([("L", random_arm(self.generator, RELATIVE))])
        self.assertEqual(self.exchange(message)[2], {"L": NOT_ABSOLUTE})
        self.expect_refused(message, {"L": CorrectionStatus.REFUSED_TIME_BACKWARDS})

    def test_empty_frame_is_refused(self):
        self.expect_refused(command(self.arms(), frame=""),
                            {"L": CorrectionStatus.REFUSED_FRAME, "R": CorrectionStatus.REFUSED_FRAME})

    def test_names_and_arms_that_do_not_match_are_refused(self):
        message = command(self.arms())
        message.arm_names = ["L"]
        self.expect_refused(message, {"L": CorrectionStatus.REFUSED_MALFORMED})
        message = command(self.arms())
        message.arm_names = ["L", "L"]
        self.expect_refused(message, {"L": CorrectionStatus.REFUSED_MALFORMED})

    def test_one_arm_can_be_switched_off_alone(self):
        set_left = rospy.ServiceProxy("/raven/corrector/left/set_mode", SetMode)
        self.assertTrue(set_left(mode="off").success)
        self.exchange(command(self.arms()))
        message = command(self.arms())
        sent, got, codes = self.exchange(message)
        self.assertEqual(codes["L"], PASSED_OFF)
        self.expect_only(message, sent, got, [("R", "position"), ("R", "orientation")])

    def test_model_of_the_other_arm_is_refused(self):
        said = []
        diagnostics = rospy.Subscriber("/diagnostics", DiagnosticArray, said.append)
        self.addCleanup(diagnostics.unregister)
        self.models["L"].publish(model_of("R"))
        # It has arrived when diagnostics say that it was refused.
        self.assertTrue(self.wait(lambda: any(
            status.name.endswith("correction left") and "a model was refused" in status.message
            for array in said for status in array.status)))
        for _ in range(20):
            self.exchange(command(self.arms()))
            self.assertEqual(self.statuses["L"][-1].model, "rigid_L")

    def test_recorder_records_the_named_arm(self):
        start = rospy.ServiceProxy("/raven/left/recorder/start", StartRecording)
        start.wait_for_service(30)
        self.assertTrue(start("arm.bag").success)
        wanted = []
        for _ in range(20):
            message = command(self.arms())
            self.exchange(message)
            self.exchange(command([("R", random_arm(self.generator))]))  # nothing of the arm
            self.exchange(command([("L", random_arm(self.generator, RELATIVE))]))  # no pose
            wanted.append((message.header.stamp, message.arms[0].tool_command.pose))
        recorded = {}
        rospy.Subscriber("/raven/left/recorder/status", RecorderStatus,
                         lambda status: recorded.update(zip(status.topics, status.messages)))
        self.assertTrue(self.wait(lambda: all(recorded.get(topic) == len(wanted) for topic in
                                              ("/raven/servo_cp", "/raven/desired/servo_cp"))), recorded)
        stopped = rospy.ServiceProxy("/raven/left/recorder/stop", StopRecording)()
        self.assertTrue(stopped.success, stopped.message)
        with rosbag.Bag(stopped.bags[0]) as bag:
            desired, sent = ([message for _, message, _ in bag.read_messages(topic)]
                             for topic in ("desired/servo_cp", "servo_cp"))
        self.assertEqual(len(desired), len(wanted))
        self.assertEqual(len(sent), len(wanted))
        for asked, command_sent, (stamp, pose) in zip(desired, sent, wanted):
            self.assertEqual(asked.header.stamp.to_nsec(), stamp.to_nsec())
            self.assertEqual(command_sent.header.stamp.to_nsec(), stamp.to_nsec())
            self.assertEqual(str(asked.pose), str(pose))
            self.assertAlmostEqual(command_sent.pose.position.x, corrected(pose, "L").position.x, delta=1e-12)


if __name__ == "__main__":
    rospy.init_node("raven_command_test")
    folder = rospy.get_param("/directory")
    rostest.rosrun("raven_correction", "raven_command", RavenCommandTest, sys.argv)
    shutil.rmtree(folder, ignore_errors=True)
