#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The recorder takes measured poses and joints from the state messages of both Raven stacks, made by genpy
from the definitions of raven_2 and raven_2_msgs: an independent serialisation of what our reader reads."""

import math
import shutil
import sys
import threading
import unittest

import genpy.dynamic
import rosbag
import rospy
import rostest

from raven_correction.msg import RecorderStatus
from raven_correction.srv import StartRecording, StopRecording

DEGREE = math.pi / 180

# raven_2/msg/raven_state.msg of uw-biorobotics/raven2: facts of its interface, written down anew.
UW = ("raven_2/raven_state", """
Header      hdr
int32       runlevel
int32       sublevel
int32       last_seq
int32[2]    type
int32[6]    pos
float32[18] ori
float32[18] ori_d
int32[6]    pos_d
duration    dt
int32[16]   encVals
int32[16]   dac_val
float32[16] tau
float32[16] mpos
float32[16] jpos
float32[16] mvel
float32[16] jvel
float32[16] mpos_d
float32[16] jpos_d
float32[2]  grasp_d
float32[16] encoffsets
float32[12] jac_vel
float32[12] jac_f
""")
HEADER = ("std_msgs/Header", "\nuint32 seq\ntime stamp\nstring frame_id\n")
UW_MD5 = "ce9e7f4969049d8bb365de3c98461a01"  # of the packages as their authors ship them
BERKELEY_MD5 = "2489ec3d939b556c05d31ea2958841b2"

BERKELEY = [
    ("raven_2_msgs/RavenState", """
Header header
uint8 runlevel
uint8 sublevel
bool pedal_down
string master
uint8 controller
ArmState[] arms
"""), HEADER,
    ("raven_2_msgs/ArmState", """
string name
uint8 type
geometry_msgs/Pose base_pose
uint8 tool_type
ToolState tool
ToolSetPoint tool_set_point
JointState[] joints
uint8 input_pins
uint8 output_pins
"""),
    ("geometry_msgs/Pose", "\nPoint position\nQuaternion orientation\n"),
    ("geometry_msgs/Point", "\nfloat64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Quaternion", "\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"),
    ("raven_2_msgs/ToolState", "\ngeometry_msgs/Pose pose\nfloat32 grasp\n"),
    ("raven_2_msgs/ToolSetPoint", "\ngeometry_msgs/Pose pose\nfloat32 grasp\n"),
    ("raven_2_msgs/JointState", """
uint16 type
int16 state
int16 STATE_NOT_READY=0
int16 STATE_POS_UNKNOWN=1
int16 STATE_HOMING1=2
int16 STATE_HOMING2=3
int16 STATE_READY=4
int16 STATE_WAIT=5
int16 STATE_HARD_STOP=6
int16 STATE_LAST_TYPE=7
string STATE_STRINGS = NOT_READY,POS_UNKNOWN,HOMING1,HOMING2,READY,WAIT,HARD_STOP,LAST_TYPE
int32 encoder_value
int32 encoder_offset
int16 dac_command
float32 position
float32 velocity
float32 motor_position
float32 motor_velocity
float32 torque
float32 gravity_estimate
JointCommand command
float32 integrated_position_error
DOFSetPoint set_point
"""),
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
    ("raven_2_msgs/DOFSetPoint", "\nfloat32 motor_position\nfloat32 motor_velocity\nfloat32 position\nfloat32 velocity\n"),
]


def types_of(definitions):
    separator = "=" * 80 + "\n"
    (name, text), *others = definitions
    return genpy.dynamic.generate_dynamic(
        name, text + "".join(f"{separator}MSG: {other}\n{more}" for other, more in others))


RavenStateUw = types_of([UW, HEADER])["raven_2/raven_state"]
BERKELEY_TYPES = types_of(BERKELEY)
RavenState, ArmState, JointState = (BERKELEY_TYPES[f"raven_2_msgs/{name}"]
                                    for name in ("RavenState", "ArmState", "JointState"))
JOINTS = {"shoulder": 0.4, "elbow": 1.3, "insertion": -0.11, "tool_roll": -0.6, "wrist_pitch": 0.2,
          "finger_1": -0.1, "finger_2": 0.5}
TYPES = {"shoulder": 0, "elbow": 1, "insertion": 2, "tool_roll": 4, "wrist_pitch": 5, "finger_1": 6, "finger_2": 7}


def uw_state(stamp, x, runlevel=3):
    """Green is at x; gold is elsewhere."""
    state = RavenStateUw()
    state.hdr.stamp = stamp
    state.runlevel = runlevel
    state.pos = [1, 2, 3, round(x * 1e6), -88820, -135347]
    c, s = math.cos(0.5), math.sin(0.5)
    state.ori = [1, 0, 0, 0, 1, 0, 0, 0, 1] + [c, -s, 0, s, c, 0, 0, 0, 1]
    jpos = [9.0] * 16
    for name, value in JOINTS.items():
        jpos[8 + TYPES[name]] = value / DEGREE  # the insertion in metres, too
    state.jpos = jpos
    return state


def berkeley_state(stamp, x, runlevel=3):
    state = RavenState()
    state.header.stamp = stamp
    state.header.frame_id = "/0_link"
    state.runlevel = runlevel
    for name, place in (("L", x), ("R", 9.0)):
        arm = ArmState()
        arm.name = name
        pose = arm.tool.pose
        pose.position.x, pose.position.y, pose.position.z = place, -0.08882, -0.135347
        pose.orientation.z, pose.orientation.w = math.sin(0.25), math.cos(0.25)
        for joint, value in JOINTS.items():
            told = JointState()
            told.type, told.position = TYPES[joint], value if name == "L" else 9.0
            arm.joints.append(told)
        state.arms.append(arm)
    return state


class RavenStateRecording(unittest.TestCase):
    def check(self, arm, topic, kind, md5, make, frame):
        self.assertEqual(kind._md5sum, md5)  # pylint: disable=protected-access
        heard, changed = {}, threading.Condition()

        def note(status):
            with changed:
                heard.update(zip(status.topics, status.messages))
                heard["findings"] = status.findings
                changed.notify_all()

        def wait(condition, act=lambda: None):
            end = rospy.get_time() + 20
            while rospy.get_time() < end:
                with changed:
                    if condition():
                        return True
                    changed.wait(0.05)
                act()
            return False

        rospy.Subscriber(f"/{arm}/recorder/status", RecorderStatus, note, queue_size=10)
        publisher = rospy.Publisher(f"/{arm}/{topic}", kind, queue_size=1000)
        start = rospy.ServiceProxy(f"/{arm}/recorder/start", StartRecording)
        start.wait_for_service(30)
        self.assertTrue(wait(lambda: publisher.get_num_connections() == 1))
        first = rospy.Time.now()
        # It is homed while the recorder listens.
        for i in range(20):
            publisher.publish(make(first + rospy.Duration.from_sec(0.001 * i), 0.0, runlevel=1 if i < 10 else 3))
        self.assertTrue(start("session.bag").success)
        begin = rospy.Time.now()
        wanted = []
        for i in range(300):
            stamp, x = begin + rospy.Duration.from_sec(0.001 * i), round(0.01 + 1e-4 * i, 6)
            wanted.append((stamp, x))
            publisher.publish(make(stamp, x))
        name = f"/{arm}/{topic}"
        self.assertTrue(wait(lambda: heard.get(name, 0) >= len(wanted)), heard)
        # A silence of more than 2 s may have hidden another homing.
        rospy.sleep(2.5)
        after = rospy.Time.now()
        publisher.publish(make(after, wanted[-1][1]))
        self.assertTrue(wait(lambda: heard.get(name, 0) > len(wanted)), heard)
        stopped = rospy.ServiceProxy(f"/{arm}/recorder/stop", StopRecording)()
        self.assertTrue(stopped.success, stopped.message)
        with rosbag.Bag(stopped.bags[0]) as bag:
            poses, joints, homings = ([message for _, message, _ in bag.read_messages(recorded)]
                                      for recorded in ("measured_cp", "measured_js", "robot_homed"))
        # The first ones may have come before the start.
        by_stamp = {pose.header.stamp.to_nsec(): pose for pose in poses}
        self.assertTrue(all(stamp.to_nsec() in by_stamp for stamp, _ in wanted))
        for stamp, x in wanted:
            pose = by_stamp[stamp.to_nsec()]
            self.assertEqual(pose.header.frame_id.lstrip("/"), frame)
            self.assertAlmostEqual(pose.pose.position.x, x, delta=1e-9)
            self.assertAlmostEqual(pose.pose.position.y, -0.08882, delta=1e-9)
            self.assertAlmostEqual(pose.pose.position.z, -0.135347, delta=1e-9)
            self.assertAlmostEqual(pose.pose.orientation.z, math.sin(0.25), delta=1e-6)
            self.assertAlmostEqual(pose.pose.orientation.w, math.cos(0.25), delta=1e-6)
        self.assertEqual(len(joints), len(poses))
        said = dict(zip(joints[-1].name, joints[-1].position))
        for joint, value in JOINTS.items():
            self.assertAlmostEqual(said[joint], value, delta=1e-6)
        self.assertAlmostEqual(said["wrist_yaw"], 0.3, delta=1e-6)
        self.assertGreaterEqual(len(homings), 2)
        self.assertGreaterEqual(homings[0].stamp, first)
        self.assertLess(homings[0].stamp, begin + rospy.Duration(30))
        self.assertGreaterEqual(homings[-1].stamp, after)

    def test_micrometres_and_degrees_of_ravenstate(self):
        self.check("uw", "ravenstate", RavenStateUw, UW_MD5, uw_state, "frame_0")

    def test_raven_state_of_the_berkeley_stack(self):
        self.check("berkeley", "raven_state", RavenState, BERKELEY_MD5, berkeley_state, "0_link")


if __name__ == "__main__":
    rospy.init_node("raven_state_test")
    folder = rospy.get_param("/directory")
    rostest.rosrun("raven_correction", "raven_state", RavenStateRecording, sys.argv)
    shutil.rmtree(folder, ignore_errors=True)
