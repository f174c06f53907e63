// SPDX-License-Identifier: BSD-3-Clause
// Draws what the overlay knows as markers for rviz: colours that the colour-blind can tell apart
// (Okabe and Ito 2008), and never by colour alone - every kind has a shape or a word of its own.
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <optional>
#include <string>
#include <vector>

#include "raven_correction/ros/overlay_history.h"

namespace raven_correction {

struct OverlayStyle {
  std::string frame = "0_link";  ///< of all markers
  double lifetime = 1.0;         ///< after which rviz removes a marker that is not renewed [s]
  double axis_length = 0.02;     ///< of the x axis of a pose; y has 3/4 of it, z half [m]
  double text_height = 0.006;    ///< of a capital letter [m]
};

struct OverlayBox {
  Eigen::Vector3d min = Eigen::Vector3d::Zero();  ///< corner, base frame [m]
  Eigen::Vector3d max = Eigen::Vector3d::Zero();  ///< opposite corner, base frame [m]
};

/// What is on the screen now; what is absent is deleted from it.
struct OverlayView {
  /// In base, where they are recent. With an error: all of the instant of that error, a delay
  /// apart, so that what is seen on the screen is error and not lag.
  std::optional<Pose> desired, command, observed;
  std::optional<TrackingError> error;   ///< the newest, where it is recent
  std::optional<OverlayBox> workspace;  ///< where the model was trained
  std::vector<std::string> status;      ///< lines of text above the scene
};

/// Namespaces, so that rviz can switch each kind: desired (axes, ball), command (axes, cube),
/// observed (axes, disc), labels (what is what), error (arrow, its text in mm and degrees),
/// errors_uncorrected (lines with heads), errors_corrected (lines without), trail_desired (line),
/// trail_command (dashes), trail_observed (dots), workspace (dashed edges), status (text). Always
/// the same markers: one that has nothing to show is a DELETE.
visualization_msgs::MarkerArray makeOverlay(const OverlayView& view, const OverlayHistory& history,
                                            const OverlayStyle& style);

/// "corrected", "passed no model", "refused stale", ...: code of CorrectionStatus in words.
std::string correctionCodeName(std::uint8_t code);
/// True for codes with which the command differs from the desired pose by the model's doing.
bool isCorrectedCode(std::uint8_t code);
/// "1.23 mm, 4.50 deg" @param position [m] @param angle [rad]
std::string errorText(double position, double angle);

}  // namespace raven_correction
