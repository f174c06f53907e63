// SPDX-License-Identifier: BSD-3-Clause
// What may be wrong: every effect of the catalogue, joint by joint, as a hypothesis with a few
// parameters and with points to start its fit from. Choosing between them is selection.h.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/diagnosis/effect_fit.h"

namespace raven_correction {

/// One cause: an effect, of one joint, of a joint and what moves it (moved, mover, ...), of several
/// joints together, or of the whole arm.
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
/// alpha of elbow", "joint_coupling of elbow by shoulder, insertion", "joint_gain of elbow, roll".
std::string hypothesisLabel(const Hypothesis& hypothesis, const KinematicChain& robot);

/// All that this recording could show: no geometry for joint data, nothing before the motors where
/// encoders drive, nothing of loads where the robot's file has no masses. motor_saturation only of
/// joints whose motor turns with other joints (else it is tracking_lag or speed_limit), and only
/// its lag and its limit: how the limit depends on posture takes a recording and a fit of its own.
/// @param simulation  whose cable coupling says which motors those are
std::vector<Hypothesis> allHypotheses(const Recording& recording,
                                      const SimulationConfig& simulation);

/// Each of these may be too weak to be claimed where all of their kind together are not: the same
/// parameter of several joints; all couplings into one joint, which are one cable's way; or all
/// couplings. Each group of at least two is one hypothesis with a parameter for each joint.
/// @param single  of these; what has shapes, and limits, are left alone
std::vector<Hypothesis> togetherHypotheses(const std::vector<Hypothesis>& single,
                                           const KinematicChain& robot);

/// Parameters of one effect and symbol as one hypothesis. @param parameters  at least one
Hypothesis hypothesisOf(std::vector<ParameterHandle> parameters, const KinematicChain& robot);

/// Its parameters joint by joint where they are couplings into several, else all of them.
std::vector<std::vector<ParameterHandle>> partsOf(const Hypothesis& hypothesis,
                                                  const KinematicChain& robot);

/// What to call its parameters: by the symbol, or where several joints have the same one, by its
/// label ("c[elbow<-shoulder]").
std::vector<std::string> parameterNames(const Hypothesis& hypothesis, const KinematicChain& robot);

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
