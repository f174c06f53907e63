// SPDX-License-Identifier: BSD-3-Clause
// Dense linear algebra, first version: Eigen behind the raw-pointer interface.
#include "raven_correction/regression/dense.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace raven_correction {
namespace {

using Map = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
using ConstMap = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

}  // namespace

void multiply(Transpose transpose_a, Transpose transpose_b, DenseIndex m, DenseIndex n,
              DenseIndex k, double alpha, const double* a, DenseIndex lda, const double* b,
              DenseIndex ldb, double beta, double* c, DenseIndex ldc) {
  const bool ta = transpose_a == Transpose::kYes;
  const bool tb = transpose_b == Transpose::kYes;
  const ConstMap A(a, ta ? k : m, ta ? m : k, Eigen::OuterStride<>(lda));
  const ConstMap B(b, tb ? n : k, tb ? k : n, Eigen::OuterStride<>(ldb));
  Map C(c, m, n, Eigen::OuterStride<>(ldc));
  if (beta == 0.0)
    C.setZero();
  else if (beta != 1.0)
    C *= beta;
  if (!ta && !tb) C.noalias() += alpha * A * B;
  if (ta && !tb) C.noalias() += alpha * A.transpose() * B;
  if (!ta && tb) C.noalias() += alpha * A * B.transpose();
  if (ta && tb) C.noalias() += alpha * A.transpose() * B.transpose();
}

void multiplySymmetric(Transpose transpose, DenseIndex n, DenseIndex k, double alpha,
                       const double* a, DenseIndex lda, double beta, double* c, DenseIndex ldc) {
  const bool t = transpose == Transpose::kYes;
  const ConstMap A(a, t ? k : n, t ? n : k, Eigen::OuterStride<>(lda));
  Map C(c, n, n, Eigen::OuterStride<>(ldc));
  if (beta == 0.0)
    C.triangularView<Eigen::Lower>().setZero();
  else if (beta != 1.0)
    C.triangularView<Eigen::Lower>() *= beta;
  if (t)
    C.selfadjointView<Eigen::Lower>().rankUpdate(A.transpose(), alpha);
  else
    C.selfadjointView<Eigen::Lower>().rankUpdate(A, alpha);
}

DenseIndex factorCholesky(DenseIndex n, double* a, DenseIndex lda) {
  Map A(a, n, n, Eigen::OuterStride<>(lda));
  return Eigen::internal::llt_inplace<double, Eigen::Lower>::blocked(A) + 1;
}

void solveLower(Transpose transpose, DenseIndex n, DenseIndex columns, const double* l,
                DenseIndex ldl, double* b, DenseIndex ldb) {
  const ConstMap L(l, n, n, Eigen::OuterStride<>(ldl));
  Map B(b, n, columns, Eigen::OuterStride<>(ldb));
  if (transpose == Transpose::kYes)
    L.transpose().triangularView<Eigen::Upper>().solveInPlace(B);
  else
    L.triangularView<Eigen::Lower>().solveInPlace(B);
}

void invertLower(DenseIndex n, double* l, DenseIndex ldl) {
  Map L(l, n, n, Eigen::OuterStride<>(ldl));
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(n, n);
  L.triangularView<Eigen::Lower>().solveInPlace(inverse);
  L.triangularView<Eigen::Lower>() = inverse;
}

void multiplyInverseFactor(DenseIndex n, double* l_inverse, DenseIndex ld) {
  Map L(l_inverse, n, n, Eigen::OuterStride<>(ld));
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(n, n);
  full.triangularView<Eigen::Lower>() = L;
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(n, n);
  product.selfadjointView<Eigen::Lower>().rankUpdate(full.transpose());
  L.triangularView<Eigen::Lower>() = product;
}

}  // namespace raven_correction
