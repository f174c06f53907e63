# SPDX-License-Identifier: BSD-3-Clause
"""Hosts of their own on this machine: network namespaces on a switch, whose cables can be cut. Needs
iproute2 and root."""

import atexit
import ctypes
import os
import re
import subprocess
from pathlib import Path

PREFIX = "raven_correction_"
CLONE_NEWNET = 0x40000000  # <linux/sched.h>


def ip(*arguments):
    """@throws CalledProcessError, OSError  it cannot be done here; stderr says why"""
    return subprocess.run(["ip", *arguments], check=True, capture_output=True, text=True).stdout


def remove_left_over():
    """What a test has left that was killed before it could clean up."""
    for line in ip("netns", "list").splitlines():
        found = re.match(PREFIX + r"(\d+)_", line)
        if found and not Path(f"/proc/{found[1]}").exists():
            ip("netns", "del", line.split()[0])


class Network:
    """Hosts NAME with the addresses 10.77.0.1, 10.77.0.2, ... in the order of their names. They and their
    switch are namespaces, so nothing of the machine's own network is touched, and it all goes with them."""

    def __init__(self, *names):
        """@throws CalledProcessError, OSError  where that is not permitted"""
        self.names = names
        self.tag = f"{PREFIX}{os.getpid()}_"
        self.made = []
        atexit.register(self.remove)
        remove_left_over()
        self.add("switch")
        ip("-n", self.tag + "switch", "link", "add", "bridge", "type", "bridge")
        ip("-n", self.tag + "switch", "link", "set", "bridge", "up")
        for name in names:
            self.add(name)
            host = self.tag + name
            ip("-n", self.tag + "switch", "link", "add", name, "type", "veth", "peer", "name", "eth0",
               "netns", host)
            ip("-n", self.tag + "switch", "link", "set", name, "master", "bridge", "up")
            ip("-n", host, "addr", "add", self.address(name) + "/24", "dev", "eth0")
            ip("-n", host, "link", "set", "eth0", "up")

    def add(self, name):
        ip("netns", "add", self.tag + name)
        self.made.append(self.tag + name)
        ip("-n", self.tag + name, "link", "set", "lo", "up")

    def address(self, name):
        return f"10.77.0.{1 + self.names.index(name)}"

    def cut(self, name):
        ip("-n", self.tag + "switch", "link", "set", name, "down")

    def join(self, name):
        ip("-n", self.tag + "switch", "link", "set", name, "up")

    def on(self, name):
        """What a command line must begin with to run on a host."""
        return ["ip", "netns", "exec", self.tag + name]

    def enter(self, name):
        """The calling thread, and those that it starts from now on, are on that host."""
        libc = ctypes.CDLL(None, use_errno=True)
        with open(f"/run/netns/{self.tag + name}", "rb") as namespace:
            if libc.setns(namespace.fileno(), CLONE_NEWNET) != 0:
                raise OSError(ctypes.get_errno(), "setns")

    def remove(self):
        while self.made:
            subprocess.run(["ip", "netns", "del", self.made.pop()], check=False, capture_output=True)
