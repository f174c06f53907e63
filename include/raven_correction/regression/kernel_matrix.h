// SPDX-License-Identifier: BSD-3-Clause
// Correlation matrices between sets of points, whole matrices at a time and threaded. The formulae
// of one pair are kernel.h.
#pragma once

#include <Eigen/Core>

#include "raven_correction/regression/kernel.h"

namespace raven_correction {

/// Points divided by the length scales, one point per column.
/// @param points  d x n;  length_scales: d, > 0, same units as the features
Eigen::MatrixXd scalePoints(const Eigen::MatrixXd& points, const Eigen::VectorXd& length_scales);

/// C(i, j) = c(|| a_i - b_j ||).
/// @param a  d x n scaled points;  b: d x m scaled points;  C: resized to n x m
void kernelMatrix(KernelType type, const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                  Eigen::MatrixXd& C);

/// Lower triangle of C(i, j) = c(|| a_i - a_j ||) and, unless null, of G(i, j) = g(|| a_i - a_j ||)
/// (kernel.h). What the strict upper triangles hold is not specified.
void kernelMatrixLower(KernelType type, const Eigen::MatrixXd& a, Eigen::MatrixXd& C,
                       Eigen::MatrixXd* G);

}  // namespace raven_correction
