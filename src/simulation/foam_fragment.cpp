// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/foam_fragment.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace raven_correction {
namespace {

constexpr int kRaySteps = 14;     // through the ball
constexpr int kBisections = 12;   // of one of them
constexpr int kGrid = 28;         // points per axis that measure a body
constexpr double kMargin = 1.32;  // of the ball: g is below 1.3

double power(double x, int exponent) noexcept {
  const double x2 = x * x;
  switch (exponent) {
    case 2:
      return x2;
    case 4:
      return x2 * x2;
    case 6:
      return x2 * x2 * x2;
    default:
      return (x2 * x2) * (x2 * x2);
  }
}

/// Calls `visit` with every point of a grid over the body that lies inside it.
template <typename Visit>
void forEachInside(const FoamFragment& fragment, const Visit& visit) {
  for (int i = 0; i < kGrid; ++i)
    for (int j = 0; j < kGrid; ++j)
      for (int k = 0; k < kGrid; ++k) {
        const Eigen::Vector3d q = (Eigen::Vector3d(i, j, k).array() + 0.5) * (2.0 / kGrid) - 1.0;
        const Eigen::Vector3d p = kMargin * q.cwiseProduct(fragment.half_size);
        if (fragment.inside(p) < 0.0) visit(p, i, j);
      }
}

}  // namespace

double FoamFragment::inside(const Eigen::Vector3d& p_fragment) const noexcept {
  const Eigen::Vector3d q = p_fragment.cwiseQuotient(half_size);
  const double rho2 = q.x() * q.x() + q.y() * q.y();
  double g = 1.0;
  if (rho2 > 1e-12) {
    const double inverse = 1.0 / std::sqrt(rho2);
    const double c1 = q.x() * inverse;
    const double s1 = q.y() * inverse;
    const double c2 = c1 * c1 - s1 * s1;
    const double s2 = 2.0 * s1 * c1;
    const double c3 = c2 * c1 - s2 * s1;
    const double s3 = s2 * c1 + c2 * s1;
    const double c5 = c3 * c2 - s3 * s2;
    const double s5 = s3 * c2 + c3 * s2;
    g += cosine[0] * c2 + cosine[1] * c3 + cosine[2] * c5;
    g += sine[0] * s2 + sine[1] * s3 + sine[2] * s5;
  }
  double F = (power(q.x(), exponent) + power(q.y(), exponent)) / power(g, exponent) +
             power(q.z(), exponent) - 1.0;
  for (const Cut& cut : cuts) F = std::max(F, cut.normal.dot(q) - cut.offset);
  return F;
}

Eigen::Vector3d FoamFragment::normal(const Eigen::Vector3d& p_fragment) const noexcept {
  const double step = 1e-3 * half_size.minCoeff();
  Eigen::Vector3d gradient;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d d = step * Eigen::Vector3d::Unit(i);
    gradient(i) = inside(p_fragment + d) - inside(p_fragment - d);
  }
  const double length = gradient.norm();
  return length > 0.0 ? Eigen::Vector3d(gradient / length) : Eigen::Vector3d::UnitZ();
}

std::optional<double> FoamFragment::hit(const Eigen::Vector3d& p_fragment_origin,
                                        const Eigen::Vector3d& direction) const noexcept {
  const double b = p_fragment_origin.dot(direction) / direction.squaredNorm();
  const double nearest2 = (p_fragment_origin - b * direction).squaredNorm();
  if (nearest2 >= radius * radius) return std::nullopt;
  const double half = std::sqrt((radius * radius - nearest2) / direction.squaredNorm());
  if (-b + half <= 0.0) return std::nullopt;
  double before = std::max(0.0, -b - half);
  const double step = (-b + half - before) / kRaySteps;
  for (int i = 0; i < kRaySteps; ++i) {
    double after = before + step;
    if (inside(p_fragment_origin + after * direction) < 0.0) {
      for (int k = 0; k < kBisections; ++k) {
        const double middle = 0.5 * (before + after);
        (inside(p_fragment_origin + middle * direction) < 0.0 ? after : before) = middle;
      }
      return after;
    }
    before = after;
  }
  return std::nullopt;
}

void FoamFragment::finish() {
  radius = 0.0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  forEachInside(*this, [&](const Eigen::Vector3d& p, int, int) {
    radius = std::max(radius, p.norm());
    sum += p;
    count += 1.0;
  });
  const double cell = (2.0 * kMargin / kGrid) * half_size.norm();  // diagonal of a cell
  radius += 0.5 * cell;
  p_fragment_centre = count > 0.0 ? Eigen::Vector3d(sum / count) : Eigen::Vector3d::Zero();
}

FragmentTruth measureFragment(const FoamFragment& fragment) {
  FragmentTruth truth;
  truth.p_field = fragment.X_field_fragment * fragment.p_fragment_centre;
  // The outline from above: columns of the field, not of the fragment, which may be tilted.
  constexpr int kCells = 20;
  std::array<bool, kCells * kCells> outline{};
  const double cell = 2.0 * fragment.radius / kCells;
  forEachInside(fragment, [&](const Eigen::Vector3d& p, int, int) {
    const Eigen::Vector3d d = fragment.X_field_fragment.q * p;
    const int i = std::clamp(static_cast<int>(d.x() / cell + 0.5 * kCells), 0, kCells - 1);
    const int j = std::clamp(static_cast<int>(d.y() / cell + 0.5 * kCells), 0, kCells - 1);
    outline[static_cast<std::size_t>(i * kCells + j)] = true;
  });
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
  double count = 0.0;
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j) {
      if (!outline[static_cast<std::size_t>(i * kCells + j)]) continue;
      const Eigen::Vector2d d(cell * (i + 0.5 - 0.5 * kCells), cell * (j + 0.5 - 0.5 * kCells));
      sum += d;
      square += d * d.transpose();
      count += 1.0;
    }
  if (count == 0.0) return truth;
  const Eigen::Vector2d mean = sum / count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(square / count -
                                                            mean * mean.transpose());
  const Eigen::Vector2d along = axes.eigenvectors().col(1);
  truth.yaw = std::atan2(along.y(), along.x());
  if (truth.yaw <= -0.5 * M_PI) truth.yaw += M_PI;
  if (truth.yaw > 0.5 * M_PI) truth.yaw -= M_PI;
  truth.length = 4.0 * std::sqrt(std::max(0.0, axes.eigenvalues()(1)));
  truth.width = 4.0 * std::sqrt(std::max(0.0, axes.eigenvalues()(0)));
  return truth;
}

FoamFragment cutFoam(const FoamShapeConfig& config, std::mt19937_64& random) {
  const auto uniform = [&](double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
  };
  FoamFragment fragment;
  const double length = uniform(config.length_min, config.length_max);
  const double width = length * uniform(config.slenderness_min, config.slenderness_max);
  fragment.half_size =
      0.5 * Eigen::Vector3d(length, width, uniform(config.height_min, config.height_max));
  fragment.exponent = 2 * std::uniform_int_distribution<int>(1, 4)(random);
  for (std::size_t n = 0; n < 3; ++n) {
    fragment.cosine[n] = uniform(-0.045, 0.045);
    fragment.sine[n] = uniform(-0.045, 0.045);
  }
  for (int cuts = std::uniform_int_distribution<int>(0, 2)(random); cuts > 0; --cuts) {
    const double angle = uniform(0.0, 2.0 * M_PI);
    fragment.cuts.push_back(
        {Eigen::Vector3d(std::cos(angle), std::sin(angle), uniform(-0.3, 0.3)).normalized(),
         uniform(0.65, 0.95)});
  }
  // Red foam: from a cold to a warm red, fresh to faded.
  const double red = uniform(0.45, 0.75);
  fragment.albedo = red * Eigen::Vector3d(1.0, uniform(0.06, 0.14), uniform(0.05, 0.16));
  fragment.grain = uniform(0.05, 0.15);
  fragment.grain_size = uniform(0.0004, 0.0009);
  fragment.grain_offset = {uniform(0.0, 0.1), uniform(0.0, 0.1)};
  fragment.finish();
  return fragment;
}

}  // namespace raven_correction
