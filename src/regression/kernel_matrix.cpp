// SPDX-License-Identifier: BSD-3-Clause
// Correlation matrices from differences of coordinates: no cancellation between near points.
#include "raven_correction/regression/kernel_matrix.h"

#include <cmath>

namespace raven_correction {

Eigen::MatrixXd scalePoints(const Eigen::MatrixXd& points, const Eigen::VectorXd& length_scales) {
  return length_scales.cwiseInverse().asDiagonal() * points;
}

void kernelMatrix(KernelType type, const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                  Eigen::MatrixXd& C) {
  C.resize(a.cols(), b.cols());
#pragma omp parallel for schedule(dynamic, 16)
  for (Eigen::Index j = 0; j < b.cols(); ++j) {
    for (Eigen::Index i = 0; i < a.cols(); ++i)
      C(i, j) = correlation(type, (a.col(i) - b.col(j)).norm());
  }
}

void kernelMatrixLower(KernelType type, const Eigen::MatrixXd& a, Eigen::MatrixXd& C,
                       Eigen::MatrixXd* G) {
  C.resize(a.cols(), a.cols());
  if (G != nullptr) G->resize(a.cols(), a.cols());
#pragma omp parallel for schedule(dynamic, 16)
  for (Eigen::Index j = 0; j < a.cols(); ++j) {
    for (Eigen::Index i = j; i < a.cols(); ++i) {
      const double r = (a.col(i) - a.col(j)).norm();
      C(i, j) = correlation(type, r);
      if (G != nullptr) (*G)(i, j) = correlationSlope(type, r);
    }
  }
}

}  // namespace raven_correction
