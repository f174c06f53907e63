#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Faults of doc/faults.md that end a trainer in the middle of a training: asked to end, and killed."""

import signal
import subprocess
import threading

from private_master import FOLDER, ProcessTest
from processes import LIMIT, NODES, kill, until

import rospy
from raven_correction.msg import WorkProgress
from raven_correction.srv import Retrain

SLOW = """process: {criterion: likelihood, length_scales: per_feature, grouping: own,
          max_hyper_points: 3000, max_exact_points: 3000, backend: exact, restarts: 20}
"""


class TrainerProcesses(ProcessTest):
    def begin_training(self):
        """@return (process, answers of the call), once it is in the middle of it"""
        bag = FOLDER / "session.bag"
        if not bag.exists():
            subprocess.run([str(NODES / "offline"), "simulate", "--trajectories", "25", "--seed", "5", "-o",
                            str(bag)], check=True, capture_output=True, timeout=2 * LIMIT)
            (FOLDER / "slow.yaml").write_text(SLOW)
        (FOLDER / "models").mkdir(exist_ok=True)
        process = self.start("trainer", data_directory=str(FOLDER), model_directory=str(FOLDER / "models"),
                             configuration=str(FOLDER / "slow.yaml"))
        told = []
        progress = rospy.Subscriber("/arm/trainer/progress", WorkProgress, told.append)
        self.addCleanup(progress.unregister)
        retrain = rospy.ServiceProxy("/arm/trainer/retrain", Retrain)
        retrain.wait_for_service(LIMIT)
        answers = []

        def call():
            try:
                answers.append(retrain(bags=[str(bag)]))
            except rospy.ServiceException as error:
                answers.append(error)

        thread = threading.Thread(target=call)
        thread.start()
        self.addCleanup(thread.join)
        self.assertTrue(until(lambda: told and told[-1].phase == "fitting", 2 * LIMIT), answers)
        return process, answers

    def test_asked_to_end_while_training(self):
        process, answers = self.begin_training()
        kill(process, signal.SIGINT)  # within LIMIT; the training would have taken minutes
        self.assertEqual(process.returncode, 0)
        self.assertTrue(until(lambda: answers))
        self.assertEqual(list((FOLDER / "models").iterdir()), [])

    def test_killed_while_training(self):
        process, answers = self.begin_training()
        kill(process)
        self.assertTrue(until(lambda: answers))
        self.assertEqual(list((FOLDER / "models").iterdir()), [])
        # One that is started again has no model, and trains as if nothing had been.
        process, _ = self.begin_training()
        kill(process, signal.SIGINT)


if __name__ == "__main__":
    unittest.main()
