# SPDX-License-Identifier: BSD-3-Clause
"""What tests of whole processes share: where the nodes are, waiting and ending."""

import os
import signal
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
NODES = Path(os.environ.get("RAVEN_BUILD", ROOT / "build")) / "devel/lib/raven_correction"
LIMIT = 30.0  # for what takes less than a second on an idle machine [s]


def until(condition, limit=LIMIT):
    end = time.monotonic() + limit
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.01)
    return True


def kill(process, how=signal.SIGKILL):
    process.send_signal(how)
    process.wait(LIMIT)
