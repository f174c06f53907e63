// SPDX-License-Identifier: BSD-3-Clause
#include "fragment_outline.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace raven_correction {
namespace {

constexpr double kCorrelation = 4.0;  // length along a contour over which its noise is one [px]
constexpr int kNear = 2;              // a contour point this near to another piece touches it [px]
constexpr double kPower = 3.0;        // of the superellipse
constexpr int kIterations = 40;
constexpr double kFlat = 1e-9;

using Vector6 = Eigen::Matrix<double, 6, 1>;  // u_left, u_right, v, log a, log b, angle
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Distance of a point from the superellipse, along the ray from its middle; > 0 outside.
double residualOf(const Vector6& x, const Eigen::Vector2d& p, bool right) {
  const Eigen::Vector2d d = p - Eigen::Vector2d(right ? x(1) : x(0), x(2));
  const double c = std::cos(x(5));
  const double s = std::sin(x(5));
  const double along = std::abs(c * d.x() + s * d.y()) / std::exp(x(3));
  const double across = std::abs(c * d.y() - s * d.x()) / std::exp(x(4));
  const double level = std::pow(std::pow(along, kPower) + std::pow(across, kPower), 1.0 / kPower);
  return level > kFlat ? d.norm() * (1.0 - 1.0 / level) : -std::exp(x(4));
}

struct Normal {
  Matrix6 H = Matrix6::Zero();
  Vector6 g = Vector6::Zero();
  double cost = 0.0;
};

}  // namespace

Outline traceOutline(const cv::Mat& labels, int piece, const std::vector<bool>& hides,
                     double noise) {
  Outline outline;
  const cv::Mat pixels = labels == piece;
  const cv::Rect box = cv::boundingRect(pixels);
  if (box.empty()) return outline;
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(pixels(box), contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE, box.tl());
  for (std::vector<cv::Point>& contour : contours)
    if (contour.size() > outline.contour.size()) outline.contour = std::move(contour);
  cv::Mat filled = cv::Mat::zeros(box.size(), CV_8UC1);
  std::vector<cv::Point> shifted;
  for (const cv::Point& p : outline.contour) shifted.push_back(p - box.tl());
  cv::fillPoly(filled, std::vector<std::vector<cv::Point>>{shifted}, cv::Scalar(255));
  const cv::Moments m = cv::moments(filled, true);
  outline.area = m.m00;
  outline.centre = {m.m10 / m.m00 + box.x, m.m01 / m.m00 + box.y};

  for (const cv::Point& p : outline.contour) {
    bool hidden = false;
    bool touching = false;
    for (int dv = -kNear; dv <= kNear && !hidden; ++dv)
      for (int du = -kNear; du <= kNear && !hidden; ++du) {
        const int u = p.x + du;
        const int v = p.y + dv;
        if (u < 0 || v < 0 || u >= labels.cols || v >= labels.rows) continue;
        const int other = labels.at<int>(v, u);
        if (other == 0 || other == piece) continue;
        touching = true;
        hidden = hides[static_cast<std::size_t>(other)];
      }
    if (touching) outline.touching_share += 1.0 / static_cast<double>(outline.contour.size());
    if (hidden)
      outline.hidden_share += 1.0 / static_cast<double>(outline.contour.size());
    else
      outline.own.emplace_back(p.x, p.y);
  }
  // Closed integral of x^2 ds over the contour, with steps of about a pixel.
  Eigen::Vector2d integral = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < outline.contour.size(); ++i) {
    const cv::Point& p = outline.contour[i];
    const cv::Point step = outline.contour[(i + 1) % outline.contour.size()] - p;
    const Eigen::Vector2d x = Eigen::Vector2d(p.x, p.y) - outline.centre;
    integral += x.cwiseAbs2() * std::hypot(step.x, step.y);
  }
  outline.variance = noise * noise * kCorrelation / (outline.area * outline.area) * integral;
  return outline;
}

OutlineCentre meanCentre(const Outline& left, const Outline& right) {
  OutlineCentre centre;
  centre.pixel = {left.centre.x(), right.centre.x(), 0.5 * (left.centre.y() + right.centre.y())};
  centre.covariance = Eigen::Vector3d(left.variance.x(), right.variance.x(),
                                      0.25 * (left.variance.y() + right.variance.y()))
                          .asDiagonal();
  return centre;
}

OutlineCentre fitCentre(const Outline& left, const Outline& right, double typical, double deviation,
                        double roughness) {
  // What neighbouring points say is one statement, so each counts for less.
  const double weight = 1.0 / (roughness * roughness * kCorrelation * 2.0);
  const double prior = (typical / deviation) * (typical / deviation);  // of log a and log b
  const auto normalEquations = [&](const Vector6& x, bool derive) {
    Normal n;
    for (const bool is_right : {false, true}) {
      for (const Eigen::Vector2d& p : is_right ? right.own : left.own) {
        const double r = residualOf(x, p, is_right);
        n.cost += weight * r * r;
        if (!derive) continue;
        Vector6 J;
        for (int i = 0; i < 6; ++i) {
          Vector6 moved = x;
          const double step = i < 3 ? 1e-3 : 1e-4;
          moved(i) += step;
          J(i) = (residualOf(moved, p, is_right) - r) / step;
        }
        n.H += weight * J * J.transpose();
        n.g += weight * r * J;
      }
    }
    for (int i = 3; i < 5; ++i) {
      const double r = x(i) - std::log(typical);
      n.cost += prior * r * r;
      n.H(i, i) += prior;
      n.g(i) += prior * r;
    }
    n.H(5, 5) += 0.1;  // a circle has no direction
    return n;
  };
  // From the middle of the larger view and a circle, turned in two ways: the better one counts.
  OutlineCentre best;
  best.converged = false;
  double best_cost = std::numeric_limits<double>::infinity();
  for (const double angle : {0.0, 0.25 * M_PI}) {
    Vector6 x;
    x << left.centre.x(), right.centre.x(), 0.5 * (left.centre.y() + right.centre.y()),
        std::log(typical * 1.1), std::log(typical * 0.95), angle;
    double damping = 1e-3;
    Normal n = normalEquations(x, true);
    for (int iteration = 0; iteration < kIterations; ++iteration) {
      Matrix6 damped = n.H;
      damped.diagonal() *= 1.0 + damping;
      const Vector6 change = -damped.ldlt().solve(n.g);
      const Vector6 next = x + change.cwiseMax(-typical).cwiseMin(typical);
      const double cost = normalEquations(next, false).cost;
      if (!(cost < n.cost)) {
        damping *= 10.0;
        if (damping > 1e8) break;
        continue;
      }
      const bool done = n.cost - cost < 1e-6 * n.cost;
      x = next;
      damping = std::max(1e-9, 0.2 * damping);
      n = normalEquations(x, true);
      if (done) break;
    }
    if (!(n.cost < best_cost)) continue;
    best_cost = n.cost;
    const Matrix6 covariance = n.H.ldlt().solve(Matrix6::Identity());
    best.pixel = x.head<3>();
    best.covariance = covariance.topLeftCorner<3, 3>();
    best.half_length = std::exp(std::max(x(3), x(4)));
    best.half_width = std::exp(std::min(x(3), x(4)));
    best.angle = x(5) + (x(3) >= x(4) ? 0.0 : 0.5 * M_PI);
    best.converged = x.allFinite() && covariance.allFinite();
  }
  return best;
}

}  // namespace raven_correction
