// SPDX-License-Identifier: BSD-3-Clause
// F at one motion: the command that produces the desired pose, how sure it is, and how much of it
// was trusted. The same for the live corrector, `offline predict` and the evaluation; limits of
// size and step are the live corrector's own (corrector.h).
#pragma once

#include <memory>
#include <optional>

#include "raven_correction/correction/model.h"
#include "raven_correction/regression/gp_predictor.h"
#include "raven_correction/simulation/inverse_arm.h"

namespace raven_correction {

struct Prediction {
  enum class Status {
    kFull,        ///< H and G in full
    kFaded,       ///< H is faded, wholly or in part: its deviation is near that of the prior, or
                  ///< the simulation of the model does not reach the pose
    kOutside,     ///< outside the workspace of G: faded towards the unmodified pose
    kModelFault,  ///< the model answered with a number that is not finite: the unmodified pose
  };
  Status status = Status::kModelFault;
  Pose command;
  Pose rigid;  ///< G alone
  Pose mean;   ///< what H is added to: G, or, with physics, the command that the simulation says
  /// Standard deviations of the command that will turn out to be the right one, in its dp (base
  /// frame) and r: of the latent function and of what no feature explains. Zero without H.
  Eigen::Vector3d sd_position = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d sd_rotation = Eigen::Vector3d::Zero();  ///< [rad]
  double h_share = 0.0;                                   ///< share of H in the command, 0 to 1
  double g_share = 0.0;  ///< share of the correction in the command, 0 to 1
};
/// "full", "faded", "outside", "model_fault".
const char* predictionStatusName(Prediction::Status status) noexcept;

class Predictor {
 public:
  /// @throws InvalidInput  the model does not fit together: sizes, a value that is not finite, a
  ///         quaternion that is not of unit length, a trust region without extent
  explicit Predictor(Correction model);

  const Correction& model() const noexcept { return model_; }

  /// Memory of one caller, made once per thread.
  struct Workspace;
  std::shared_ptr<Workspace> makeWorkspace() const;

  /// No allocation, lock or throw. M is G, or, where the model has physics, the command of its
  /// simulation (physics.h); where that does not reach the pose, G alone (w_H = 0).
  ///
  ///   w_H = 1 - smoothstep(rho; fade_start, fade_end), rho the largest ratio of predicted to prior
  ///         deviation of the latent outputs
  ///   w_G = 1 - smoothstep(distance to the workspace box; margin, 2 margin)
  ///   command = x moved towards (M x moved towards F x by w_H) by w_G
  Prediction predict(const Motion& motion, Workspace& workspace) const noexcept;

 private:
  Correction model_;
  std::optional<InverseArm> physics_;
  std::unique_ptr<const GpPredictor> process_;  ///< null where the model is rigid only
  Eigen::Matrix<double, 6, 1> noise_variance_ = Eigen::Matrix<double, 6, 1>::Zero();
};

}  // namespace raven_correction
