// SPDX-License-Identifier: BSD-3-Clause
// Draws for rviz what a model was trained on and what it says: samples, rejected ones by reason,
// the hull of the trained region, the correction on a grid. They change with the model only; what
// moves is overlay_markers.h.
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include "raven_correction/TrainingSamples.h"
#include "raven_correction/correction/predictor.h"
#include "raven_correction/ros/overlay_markers.h"

namespace raven_correction {

/// Namespaces: samples_kept (balls), rejected_REASON (cubes, with reason and count in words; one
/// namespace per reason), trained_hull (faces and edges about samples_kept), error_field (arrows
/// from a desired pose to its command, at rest, in the mean orientation of the training; thin and
/// grey where the model fades). The first marker deletes what was drawn before; the others stay
/// until then.
/// @param samples  null: unknown, nothing of them is drawn
/// @param model    null: none, no error field
visualization_msgs::MarkerArray makeTrainingMarkers(const TrainingSamples* samples,
                                                    const Predictor* model,
                                                    const OverlayStyle& style);

}  // namespace raven_correction
