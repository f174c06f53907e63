// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/correction/predictor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "raven_correction/correction/physics.h"
#include "raven_correction/error.h"

namespace raven_correction {

struct Predictor::Workspace {
  std::array<double, kMaxFeatures> features{};
  std::shared_ptr<GpPredictor::Workspace> process;
};

const char* predictionStatusName(Prediction::Status status) noexcept {
  switch (status) {
    case Prediction::Status::kFull:
      return "full";
    case Prediction::Status::kFaded:
      return "faded";
    case Prediction::Status::kOutside:
      return "outside";
    case Prediction::Status::kModelFault:
      break;
  }
  return "model_fault";
}

namespace {

/// 0 below `low`, 1 above `high`, with zero slope at both ends.
double smoothStep(double value, double low, double high) noexcept {
  const double s = std::clamp((value - low) / (high - low), 0.0, 1.0);
  return s * s * (3.0 - 2.0 * s);
}

void checkModel(const Correction& model) {
  const TrustRegion& trust = model.trust;
  if (!isFinite(model.rigid) || !hasUnitQuaternion(model.rigid))
    throw InvalidInput("model: the rigid transform is not a finite pose with a unit quaternion");
  if (!(std::abs(model.mean_orientation.norm() - 1.0) <= kUnitTolerance))
    throw InvalidInput("model: the mean orientation is not a unit quaternion");
  if (!std::isfinite(model.delay))
    throw InvalidInput(format("model: delay = %g s is not finite", model.delay));
  checkMotionOptions(model.motion);
  if (!trust.workspace_min.allFinite() || !trust.workspace_max.allFinite() ||
      !(trust.workspace_min.array() <= trust.workspace_max.array()).all() ||
      !(trust.workspace_margin > 0.0) || !std::isfinite(trust.workspace_margin))
    throw InvalidInput(
        "model: the workspace box is not finite, is turned over, or its margin is "
        "not positive");
  if (!(trust.fade_start > 0.0) || !(trust.fade_start < trust.fade_end) || trust.fade_end > 1.0)
    throw InvalidInput(format("model: fade from %g to %g; must be 0 < start < end <= 1",
                              trust.fade_start, trust.fade_end));
  if (model.process.groups.empty()) return;
  if (model.process.outputs != 6 ||
      model.process.features != static_cast<int>(featureCount(model.motion)))
    throw InvalidInput(
        format("model: the process maps %d features to %d outputs, expected %zu to "
               "6",
               model.process.features, model.process.outputs, featureCount(model.motion)));
}

}  // namespace

Predictor::Predictor(Correction model) : model_(std::move(model)) {
  checkModel(model_);
  model_.rigid.q.normalize();
  model_.mean_orientation.normalize();
  physics_ = inverseArmOf(model_.physics);
  if (model_.process.groups.empty()) return;
  process_ = std::make_unique<const GpPredictor>(model_.process);  // checks the groups
  for (const GpGroup& group : model_.process.groups)
    for (std::size_t k = 0; k < group.outputs.size(); ++k)
      noise_variance_(group.outputs[k]) = group.noise_variance(static_cast<Eigen::Index>(k));
}

std::shared_ptr<Predictor::Workspace> Predictor::makeWorkspace() const {
  auto workspace = std::make_shared<Workspace>();
  if (process_) workspace->process = process_->makeWorkspace();
  return workspace;
}

Prediction Predictor::predict(const Motion& motion, Workspace& workspace) const noexcept {
  Prediction prediction;
  prediction.command = motion.pose;
  prediction.rigid = model_.rigid * motion.pose;
  prediction.mean = prediction.rigid;
  bool out_of_reach = false;
  if (physics_) {
    const InverseArm::Answer answer = physics_->solve(pathOf(motion, model_.motion));
    out_of_reach = !answer.reached;
    if (answer.reached) prediction.mean = answer.command;
  }
  Pose full = prediction.mean;
  if (process_) {
    Eigen::Matrix<double, 6, 1> y, variance;
    computeFeatures(motion, model_.rigid, model_.mean_orientation, model_.motion,
                    workspace.features.data());
    process_->predict(workspace.features.data(), y.data(), variance.data(), *workspace.process);
    if (!y.allFinite() || !variance.allFinite()) return prediction;
    const Eigen::Matrix<double, 6, 1> latent = variance.cwiseMax(0.0);
    const Eigen::Matrix<double, 6, 1> sd = (latent + noise_variance_).cwiseSqrt();
    prediction.sd_position = sd.head<3>();
    prediction.sd_rotation = sd.tail<3>();
    double ratio = 0.0;
    for (Eigen::Index k = 0; k < 6; ++k)
      if (process_->priorDeviation()(k) > 0.0)
        ratio = std::max(ratio, std::sqrt(latent(k)) / process_->priorDeviation()(k));
    prediction.h_share = 1.0 - smoothStep(ratio, model_.trust.fade_start, model_.trust.fade_end);
    if (out_of_reach) prediction.h_share = 0.0;
    full = applyCorrection(prediction.mean, y * prediction.h_share);
  }
  const double margin = model_.trust.workspace_margin;
  prediction.g_share =
      1.0 - smoothStep(distanceFromWorkspace(motion.pose.p, model_.trust), margin, 2.0 * margin);
  prediction.command =
      prediction.g_share == 1.0 ? full : interpolate(motion.pose, full, prediction.g_share);
  if (!isFinite(prediction.command)) {
    prediction.command = motion.pose;
    return prediction;
  }
  prediction.status = prediction.g_share < 1.0               ? Prediction::Status::kOutside
                      : out_of_reach                         ? Prediction::Status::kFaded
                      : prediction.h_share < 1.0 && process_ ? Prediction::Status::kFaded
                                                             : Prediction::Status::kFull;
  return prediction;
}

}  // namespace raven_correction
