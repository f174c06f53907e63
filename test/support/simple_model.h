// SPDX-License-Identifier: BSD-3-Clause
// A small correction that tests can reason about: a rigid step, and a Gaussian process learnt from
// a smooth error field.
#pragma once

#include <cmath>

#include "raven_correction/correction/model.h"
#include "support/random_poses.h"

namespace raven_correction {

/// The error field of simpleModel(): what turns x_G into the command.
inline Eigen::Matrix<double, 6, 1> fieldAt(const Pose& after_rigid) {
  Eigen::Matrix<double, 6, 1> y;
  y << 0.004 * std::sin(30.0 * after_rigid.p.x()), 0.003 * std::cos(20.0 * after_rigid.p.y()),
      0.002, 0.05 * std::sin(25.0 * after_rigid.p.z()), 0.02, 0.0;
  return y;
}

/// Trained on poses within 5 cm of `centre`, orientations within 0.3 rad of it.
inline Correction simpleModel(VelocityKind velocity = VelocityKind::kCausal,
                              const Pose& centre = Pose(),
                              const Pose& rigid = {{0.01, -0.005, 0.008},
                                                   expRotation({0.05, -0.02, 0.1})},
                              const MotionOptions& motion_options = {}) {
  Correction model;
  model.id = "simple";
  model.version = "test";
  model.frame = "0_link";
  model.trained_at = 1000.0;
  model.delay = 0.1;
  model.rigid = rigid;
  model.motion = motion_options;
  model.motion.velocity = velocity;
  model.trust.workspace_min = centre.p.array() - 0.05;
  model.trust.workspace_max = centre.p.array() + 0.05;
  model.mean_orientation = model.rigid.q * centre.q;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-0.05, 0.05);
  const Eigen::Index n = 200, d = static_cast<Eigen::Index>(featureCount(model.motion));
  Eigen::MatrixXd x(n, d), y(n, 6);
  Eigen::VectorXd row(d);
  for (Eigen::Index i = 0; i < n; ++i) {
    Motion motion;
    motion.pose.p = {uniform(random), uniform(random), uniform(random)};
    motion.pose.p += centre.p;
    motion.pose.q = expRotation(randomVector(random, 0.1)) * centre.q;
    computeFeatures(motion, model.rigid, model.mean_orientation, model.motion, row.data());
    x.row(i) = row.transpose();
    y.row(i) = fieldAt(model.rigid * motion.pose).transpose();
  }
  GpConfig config;
  config.max_hyper_points = 100;
  config.inducing_points = 80;
  config.groups = {{0, 1, 2}, {3, 4, 5}};
  model.process = fitGp(x, y, config).model;
  return model;
}

}  // namespace raven_correction
