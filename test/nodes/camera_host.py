#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The driver of motion capture on a host of its own: takes what the simulator's cameras see
(cameras/measured_cp) and publishes it as mocap/measured_cp, with the stamps of this host, whose clock is
off by as much as was said last on clock_error [s]."""

import rospy
from geometry_msgs.msg import PoseStamped
from std_msgs.msg import Float64


def main():
    rospy.init_node("cameras")
    error = rospy.Duration(0)
    seen = rospy.Publisher("mocap/measured_cp", PoseStamped, queue_size=1000, tcp_nodelay=True)

    def set_error(message):
        nonlocal error
        error = rospy.Duration.from_sec(message.data)

    def publish(message):
        message.header.stamp += error
        seen.publish(message)

    rospy.Subscriber("clock_error", Float64, set_error)
    rospy.Subscriber("cameras/measured_cp", PoseStamped, publish, tcp_nodelay=True)
    rospy.spin()


if __name__ == "__main__":
    main()
