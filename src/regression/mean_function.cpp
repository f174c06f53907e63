// SPDX-License-Identifier: BSD-3-Clause
// Bases of the mean function.
#include "raven_correction/regression/mean_function.h"

#include "raven_correction/error.h"

namespace raven_correction {

MeanType meanFromName(const std::string& name) {
  if (name == "zero") return MeanType::kZero;
  if (name == "constant") return MeanType::kConstant;
  if (name == "linear") return MeanType::kLinear;
  throw InvalidInput(format("mean '%s' is unknown; use zero, constant or linear", name.c_str()));
}

Eigen::MatrixXd meanBasis(MeanType type, const Eigen::MatrixXd& points) {
  const Eigen::Index n = points.cols();
  Eigen::MatrixXd basis;
  switch (type) {
    case MeanType::kZero:
      basis.resize(n, 0);
      break;
    case MeanType::kConstant:
      basis = Eigen::MatrixXd::Ones(n, 1);
      break;
    case MeanType::kLinear:
      basis.resize(n, 1 + points.rows());
      basis.col(0).setOnes();
      basis.rightCols(points.rows()) = points.transpose();
      break;
  }
  return basis;
}

Eigen::MatrixXd evaluateMean(const Eigen::MatrixXd& mean_weights, const Eigen::MatrixXd& points) {
  Eigen::MatrixXd mean = points.transpose() * mean_weights.bottomRows(mean_weights.rows() - 1);
  mean.rowwise() += mean_weights.row(0);
  return mean;
}

}  // namespace raven_correction
