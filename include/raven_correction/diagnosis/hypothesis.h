// SPDX-License-Identifier: BSD-3-Clause
// What may be wrong: every effect of the catalogue, joint by joint, as a hypothesis with a few
// parameters and with points to start its fit from. Choosing between them is selection.h.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/diagnosis/effect_fit.h"

namespace raven_correction {

/// One cause: an effect, of one joint, of a pair of joints (moved, mover), or of the whole arm.
struct Hypothesis {
  std::string effect;
  std::vector<int> joints;                  ///< rows of the chain; empty: the whole arm
  std::vector<ParameterHandle> parameters;  ///< amplitudes first, then shapes
  /// How many of the last parameters only shape what the amplitudes size: at amplitude 0 they do
  /// nothing (a time constant, a period, an instant).
  std::size_t shapes = 0;
  /// Shapes that a gradient cannot improve: the instant of a shift. They keep their start.
  std::size_t fixed_shapes = 0;

  std::size_t amplitudes() const { return parameters.size() - shapes; }
};

/// A speed that is not exceeded, where 0 stands for no limit: the smaller it is, the more it does.
bool isLimit(const std::string& effect, const std::string& symbol) noexcept;

/// "backlash of elbow", "joint_coupling of elbow by shoulder", "base_registration", "link_geometry
/// alpha of elbow".
std::string hypothesisLabel(const Hypothesis& hypothesis, const KinematicChain& robot);

/// All that this recording could show: no geometry for joint data, nothing before the motors where
/// encoders drive, nothing of loads where the robot's file has no masses. motor_saturation only of
/// joints whose motor turns with other joints (else it is tracking_lag or speed_limit), and only
/// its lag and its limit: how the limit depends on posture takes a recording and a fit of its own.
/// @param simulation  whose cable coupling says which motors those are
std::vector<Hypothesis> allHypotheses(const Recording& recording,
                                      const SimulationConfig& simulation);

/// What the starts need to know of the recording.
struct RecordingSummary {
  double start = 0.0;      ///< of the session: first set-point or observation [s]
  double duration = 0.0;   ///< from there to the last observation [s]
  JointVector peak_speed;  ///< 99 % quantile of |dq/dt| of the set-points [rad/s, m/s]
  JointVector range;       ///< of the set-points [rad, m]
};
RecordingSummary summarise(const Recording& recording);

/// Values of all parameters to begin with: amplitudes at a size that shows, shapes spread over what
/// the recording can show. More of them where the error surface has several valleys. Periodic
/// errors and shifts get none here: what the residual itself suggests is residual_starts.h.
std::vector<Eigen::VectorXd> startingPoints(const Hypothesis& hypothesis,
                                            const RecordingSummary& recording,
                                            const SimulationConfig& simulation);

}  // namespace raven_correction
