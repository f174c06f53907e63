# SPDX-License-Identifier: BSD-3-Clause
"""A master of a test's own, and nodes that it starts, kills and starts again. To be imported before rospy,
which reads the environment that is set here."""

import os
import shutil
import socket
import subprocess
import tempfile
import unittest
import xmlrpc.client
from pathlib import Path

from processes import LIMIT, NODES, kill, until


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


PORT = free_port()
os.environ["ROS_MASTER_URI"] = f"http://127.0.0.1:{PORT}"
os.environ["ROS_IP"] = "127.0.0.1"
FOLDER = Path(tempfile.mkdtemp(prefix="raven_correction_processes_"))
os.environ["ROS_LOG_DIR"] = str(FOLDER / "log")

import rospy  # noqa: E402 pylint: disable=wrong-import-position


def master_answers():
    try:
        return xmlrpc.client.ServerProxy(os.environ["ROS_MASTER_URI"]).getPid("/test")[0] == 1
    except OSError:
        return False


class ProcessTest(unittest.TestCase):
    """One master for all tests of a class, which is also a node."""

    @classmethod
    def setUpClass(cls):
        cls.start_master()
        rospy.init_node("processes_test", disable_signals=True)

    @classmethod
    def tearDownClass(cls):
        rospy.signal_shutdown("done")
        cls.kill_master()
        shutil.rmtree(FOLDER, ignore_errors=True)

    @classmethod
    def start_master(cls):
        cls.master = subprocess.Popen(["rosmaster", "--core", "-p", str(PORT)],
                                      stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        assert until(master_answers), "the master does not start"

    @classmethod
    def kill_master(cls):
        kill(cls.master)

    def start(self, node, name="", ns="/arm", **parameters):
        """Starts a node with these parameters alone; it is killed after the test. What it says is in
        FOLDER/NAME.log. @param name  other than that of the node"""
        name = name or node
        if rospy.has_param(f"{ns}/{name}"):
            rospy.delete_param(f"{ns}/{name}")
        for parameter, value in parameters.items():
            rospy.set_param(f"{ns}/{name}/{parameter}", value)
        log = open(FOLDER / f"{name}.log", "w")  # pylint: disable=consider-using-with
        self.addCleanup(log.close)
        process = subprocess.Popen([str(NODES / node), f"__ns:={ns}", f"__name:={name}"],
                                   stdout=log, stderr=subprocess.STDOUT)
        self.addCleanup(lambda: process.poll() is None and kill(process))
        return process
