# SPDX-License-Identifier: BSD-3-Clause
"""A model that is its rigid transform alone, everywhere within a metre: what it does to a pose can be
written down."""

import math

from raven_correction.msg import CorrectionModel


def rigid_model(name, shift, turn=0.0, arm=""):
    """@param shift x, y, z [m]  @param turn about z [rad]  @param arm whose model it is"""
    model = CorrectionModel()
    model.header.frame_id = "0_link"
    model.format = CorrectionModel.FORMAT
    model.id = name
    model.arm = arm
    model.units = "m rad"
    model.rigid.position.x, model.rigid.position.y, model.rigid.position.z = shift
    model.rigid.orientation.z, model.rigid.orientation.w = math.sin(turn / 2), math.cos(turn / 2)
    model.mean_orientation.w = 1.0
    model.velocity, model.velocity_window, model.max_gap = "none", 0.1, 0.15
    for corner, value in ((model.workspace_min, -1.0), (model.workspace_max, 1.0)):
        corner.x = corner.y = corner.z = value
    model.workspace_margin = 0.05
    model.fade_start, model.fade_end = 0.8, 0.95
    return model
