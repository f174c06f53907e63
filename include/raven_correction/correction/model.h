// SPDX-License-Identifier: BSD-3-Clause
// The learnt correction F = H o G as plain data: what a model file holds, and nothing that is only
// needed to compute fast. Using it is predictor.h, making it training.h.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "raven_correction/correction/motion.h"
#include "raven_correction/geometry/pose.h"
#include "raven_correction/regression/gaussian_process.h"
#include "raven_correction/simulation/inverse_arm.h"
#include "raven_correction/simulation/simulation_config.h"

namespace raven_correction {

/// Where the correction fades: H where its deviation is high, G outside its workspace.
struct TrustRegion {
  Eigen::Vector3d workspace_min = Eigen::Vector3d::Zero();  ///< of training poses before G [m]
  Eigen::Vector3d workspace_max = Eigen::Vector3d::Zero();  ///< of training poses before G [m]
  /// Desired poses lie as far from the observed ones as the robot errs, so the box is grown by this
  /// margin, > 0; G is gone when the distance to the box is twice as much. [m]
  double workspace_margin = 0.05;
  /// Ratio of predicted to prior deviation at which H begins to fade and at which it is gone,
  /// 0 < start < end <= 1 [-]. At 1 the data say nothing.
  double fade_start = 0.8;
  double fade_end = 0.95;
};

/// Of a position from the workspace box; 0 inside. [m]
double distanceFromWorkspace(const Eigen::Vector3d& p, const TrustRegion& trust) noexcept;

/// Conventions (design, section 5): a desired pose x = (p, R) goes to x_G = G x = (p_G, R_G); the
/// process learns y = (dp, r) with command position p_G + dp (base frame) and orientation
/// R_G exp(r) (frame of the tool after the rigid step). With physics, the command that the
/// simulation says (physics.h) takes the place of x_G there; features stay those after G.
struct Correction {
  std::string id;              ///< unique name
  std::string version;         ///< of the package that trained it
  double trained_at = 0.0;     ///< Unix time [s]
  std::string frame = "base";  ///< base frame of all poses
  std::string arm;             ///< robot and arm it is for; empty: not known
  std::string tool;            ///< on that arm; empty: not known
  std::string pose_type;       ///< message type of the commands; empty: not known
  double homed_at = 0.0;       ///< last homing or silence, recordings' clock; 0: none known [s]
  double expires_at = 0.0;     ///< Unix time; 0: never [s]
  std::vector<std::string> inputs;  ///< files it was trained on
  std::string input_hash;           ///< of the training pairs
  std::string configuration;        ///< the complete trainer configuration, YAML

  double delay = 0.0;  ///< observation behind command [s]
  /// The same by speeds (dataset/speed_delay.h), to compare with later; nan: they do not tell [s].
  double speed_delay = std::numeric_limits<double>::quiet_NaN();
  Pose rigid;  ///< G, applied from the left
  Eigen::Quaterniond mean_orientation = Eigen::Quaterniond::Identity();  ///< after G
  MotionOptions motion;
  GpModel process;  ///< H; without groups F is G alone (or what the simulation says)
  /// Physics as the mean: the simulation whose way back comes before H. All of it, so that a model
  /// needs no file.
  struct Physics {
    SimulationTexts texts;  ///< empty: there is none
    InverseTiming timing;
    bool empty() const noexcept { return texts.simulation.empty(); }
  } physics;
  TrustRegion trust;

  std::size_t training_pairs = 0;  ///< learnt from: cleaned, and with physics in its reach
  std::size_t training_trajectories = 0;
  struct HeldOut {  ///< norms of the mean absolute errors on trajectories left out of a fit
    double position_before = std::numeric_limits<double>::quiet_NaN();  ///< no correction [m]
    double angle_before = std::numeric_limits<double>::quiet_NaN();     ///< ZYX angles [rad]
    double position_after = std::numeric_limits<double>::quiet_NaN();   ///< this model [m]
    double angle_after = std::numeric_limits<double>::quiet_NaN();      ///< this model [rad]
  } held_out;
};

/// Features of the process: position and rotation vector relative to the mean orientation, then
/// (v, w) of each twist, then (p, r) of the play where there is one, everything after G; or, with
/// the play of joints, theirs instead of (p, r): 6 (1 + twistCount() + hasPlay()).
std::size_t featureCount(const MotionOptions& options) noexcept;
constexpr std::size_t kMaxFeatures = 6 * (2 + kMaxTwists);

/// Writes featureCount() numbers. No allocation.
/// @param motion  before G, in base [m, rad, s]
/// @param rigid   G
/// @param mean_orientation  after G
/// @param options  with which `motion` was estimated
/// @param features  x y z [m], rotation vector in the frame of the mean orientation [rad], then for
///                  each twist v [m/s] and w [rad/s] in base, then of the play p [m] and r [rad],
///                  or of the play of each joint its share [-]
void computeFeatures(const Motion& motion, const Pose& rigid,
                     const Eigen::Quaterniond& mean_orientation, const MotionOptions& options,
                     double* features) noexcept;

/// y = (dp, r) that turns x_G (or what physics says) into the command: x y z in base [m], rotation
/// vector in the frame of the tool at x_G [rad].
Eigen::Matrix<double, 6, 1> correctionBetween(const Pose& after_rigid,
                                              const Pose& command) noexcept;
/// The command that y = (dp, r), as from correctionBetween(), makes of x_G (or of what physics
/// says), in base.
Pose applyCorrection(const Pose& after_rigid, const Eigen::Matrix<double, 6, 1>& y) noexcept;

}  // namespace raven_correction
