// SPDX-License-Identifier: BSD-3-Clause
// A corrector as it is shipped. Its correction costs what that of config/trainer.yaml does:
// features, points and outputs; what it has learnt is made up. Its priority is that of
// robot.launch.
#pragma once

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <regex>
#include <stdexcept>
#include <string>

#include "raven_correction/correction/model.h"
#include "raven_correction/correction/training_config.h"

namespace raven_correction {
namespace bench {

/// A file of the package.
inline std::string shippedFile(const std::string& name) {
  const char* const root = std::getenv("RAVEN_ROOT");  // ./run sets it
  return std::string(root == nullptr ? "." : root) + "/" + name;
}

/// Real-time priority of the corrector that robot.launch starts.
inline int launchedPriority() {
  std::ifstream file(shippedFile("launch/robot.launch"));
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  std::smatch found;
  if (!std::regex_search(text, found, std::regex("\"realtime_priority\" default=\"([0-9]+)\"")))
    throw std::runtime_error(shippedFile("launch/robot.launch") + " sets no realtime_priority");
  return std::stoi(found[1]);
}

inline Correction modelOfShippedSize() {
  TrainingConfig config = loadTrainingConfig(shippedFile("config/trainer.yaml"));
  Correction model;
  model.id = "bench";
  model.frame = "0_link";
  model.rigid = {{0.01, -0.005, 0.008}, expRotation({0.05, -0.02, 0.1})};
  model.mean_orientation = model.rigid.q;
  model.motion = config.motion;
  model.trust.workspace_min.setConstant(-0.05);
  model.trust.workspace_max.setConstant(0.05);
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const Eigen::Index rows = config.process.max_exact_points;
  const auto features = static_cast<Eigen::Index>(featureCount(config.motion));
  Eigen::MatrixXd x(rows, features), y(rows, 6);
  for (double& value : x.reshaped()) value = 0.05 * normal(random);
  for (Eigen::Index k = 0; k < y.cols(); ++k)
    y.col(k) = 0.01 * (20.0 * x.col(k)).array().sin() + 0.01 * x.col(k + 6).array();
  config.process.criterion = HyperCriterion::kLikelihood;  // there are no motions to leave out
  config.process.max_hyper_points = 200;
  model.process = fitGp(x, y, config.process).model;
  return model;
}

}  // namespace bench
}  // namespace raven_correction
