// SPDX-License-Identifier: BSD-3-Clause
// Which rows stand for all in a sparse Gaussian process. What is computed from them is
// posterior.h.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "raven_correction/regression/kernel.h"

namespace raven_correction {

/// Rows chosen one by one, each where the points chosen so far leave (nearly, within 20 %, for
/// speed) the largest prior variance: a pivoted Cholesky factor of the correlation matrix. The
/// first of many are thus themselves a good smaller choice. It ends early when every row is known
/// to 1e-10 of the prior variance, so repeated rows are never chosen twice.
/// @param scaled       d x n, in units of the length scales
/// @param count        rows wanted, > 0
/// @param max_candidates  rows looked at, chosen by seed when there are more
/// @return indices of columns of `scaled`, at most `count`, at least one
/// Source: Burt, Rasmussen, van der Wilk 2020, Convergence of sparse variational inference in
///         Gaussian processes regression, section 4, arXiv:2008.00323
std::vector<Eigen::Index> chooseInducingPoints(KernelType kernel, const Eigen::MatrixXd& scaled,
                                               Eigen::Index count, Eigen::Index max_candidates,
                                               std::uint64_t seed);

/// `count` of n indices without repetition, in increasing order; all when count >= n.
std::vector<Eigen::Index> sampleIndices(Eigen::Index n, Eigen::Index count, std::uint64_t seed);

/// Columns of a d x n matrix, in the order of `indices`.
Eigen::MatrixXd selectColumns(const Eigen::MatrixXd& matrix,
                              const std::vector<Eigen::Index>& indices);

/// Rows of an n x q matrix, in the order of `indices`.
Eigen::MatrixXd selectRows(const Eigen::MatrixXd& matrix, const std::vector<Eigen::Index>& indices);

}  // namespace raven_correction
