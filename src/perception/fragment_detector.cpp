// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/perception/fragment_detector.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "foam_colour.h"
#include "foam_marks.h"
#include "foam_pieces.h"
#include "fragment_outline.h"
#include "height_map.h"
#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr double kMargin = 0.006;          // around the field: a fragment hangs over its edge [m]
constexpr double kRowTolerance = 3.0;      // between both images of an unhidden fragment [px]
constexpr double kAreaRatio = 2.5;         // between both images
constexpr double kHiddenShare = 0.06;      // of a contour; less is not fitted
constexpr double kTypicalHalf = 0.28;      // of length_max: half axis of a typical fragment
constexpr double kHalfDeviation = 0.07;    // of length_max
constexpr double kRoughness = 0.00035;     // of an outline about the superellipse [m]
constexpr double kShapeCorrelation = 0.9;  // both cameras see nearly the same shape
constexpr double kSeamNoise = 0.07;  // of a centre, per share of the contour and root of the area
constexpr double kSideNoise = 2.5;   // the outline in an image has the body's sides in it
constexpr double kYawFloor = 0.05;   // [rad]
constexpr double kSuperellipseArea = 3.53;  // per product of the half axes, exponent 3
constexpr double kSeenMin = 0.4;     // of a fragment: too little is seen of others to tell them
constexpr double kFlatShare = 0.55;  // height of the centre per median height of the surface
constexpr double kSurfaceNoise = 0.0002;  // of the height of a surface [m]
constexpr double kLeaning = 0.37;   // of the mean thickness: from the centre of what leans to its
                                    // surface
constexpr double kWholeArea = 0.6;  // of the smallest fragment, per length_min^2
constexpr double kGate = 3.5;       // deviations
constexpr double kHeightAgreement = 0.004;  // of the centre from half of the top's height [m]

void checkConfig(const FragmentDetectorConfig& c) {
  const auto require = [](bool good, const std::string& text) {
    if (!good) throw InvalidInput("fragment detector: " + text);
  };
  require(
      c.field_width > 0.0 && c.field_depth > 0.0 && c.field_width <= 1.0 && c.field_depth <= 1.0,
      format("field of %g x %g m, each must be in (0, 1]; are they in mm?", c.field_width,
             c.field_depth));
  require(c.height_max > c.height_min && c.height_max <= 0.1,
          format("heights from %g to %g m are no range below 0.1 m; are they in mm?", c.height_min,
                 c.height_max));
  require(c.length_min > 0.0 && c.length_max > c.length_min && c.length_max <= 0.1,
          format("lengths from %g to %g m are no range in (0, 0.1]; are they in mm?", c.length_min,
                 c.length_max));
  require(c.thickness_min > 0.0 && c.thickness_max > c.thickness_min && c.thickness_max <= 0.1,
          format("thicknesses from %g to %g m are no range in (0, 0.1]; are they in mm?",
                 c.thickness_min, c.thickness_max));
  require(c.redness_min > 0.0 && c.redness_min < 3.0,
          format("redness_min = %g, must be in (0, 3); 0.3 is a good start", c.redness_min));
  require(c.outline_noise > 0.0 && c.outline_noise <= 10.0 && c.shape_noise >= 0.0 &&
              c.shape_noise <= 1.0,
          format("outline_noise = %g px must be in (0, 10], shape_noise = %g in [0, 1]",
                 c.outline_noise, c.shape_noise));
}

void checkImage(const cv::Mat& image, const PinholeCamera& camera, const char* name) {
  if (image.empty()) throw InvalidInput(format("fragment detector: the %s image is empty", name));
  if (image.type() != CV_8UC3)
    throw InvalidInput(
        format("fragment detector: the %s image has %d channels of depth %d, must be 3 of 8 bits, "
               "unsigned (bgr8)",
               name, image.channels(), image.depth()));
  if (image.cols != camera.width || image.rows != camera.height)
    throw InvalidInput(
        format("fragment detector: the %s image is %d x %d px, but its camera was calibrated at "
               "%d x %d; switch off binning and regions of interest, or calibrate again",
               name, image.cols, image.rows, camera.width, camera.height));
}

template <int kRows, int kCols>
cv::Mat toCv(const Eigen::Matrix<double, kRows, kCols>& m) {
  cv::Mat result(kRows, kCols, CV_64FC1);
  for (int i = 0; i < kRows; ++i)
    for (int j = 0; j < kCols; ++j) result.at<double>(i, j) = m(i, j);
  return result;
}

void makeMaps(const PinholeCamera& camera, cv::Mat& map, cv::Mat& fine) {
  const Eigen::Matrix3d projection = camera.P.leftCols<3>();
  cv::initUndistortRectifyMap(toCv<3, 3>(camera.K), toCv<5, 1>(camera.D), toCv<3, 3>(camera.R),
                              toCv<3, 3>(projection), {camera.width, camera.height}, CV_16SC2, map,
                              fine);
}

double wrapHalfTurn(double angle) {
  const double wrapped = std::remainder(angle, M_PI);
  return wrapped <= -0.5 * M_PI ? 0.5 * M_PI : wrapped;
}

/// Second moments of an area on the platform's plane, and how they shake with its contour.
struct PlaneMoments {
  Eigen::Matrix2d covariance;  // of the area [m^2]
  double yaw = 0.0;            // of the long axis [rad]
  double yaw_variance = 0.0;   // [rad^2]
};

/// Moments of a polygon: mu_11 of an area A changes by (1/A) closed integral of x y d ds where the
/// contour moves outwards by d, and the axis turns by that over the difference of the eigenvalues.
PlaneMoments momentsOf(const std::vector<Eigen::Vector2d>& polygon, double noise,
                       double correlation) {
  double area = 0.0;
  Eigen::Vector2d first = Eigen::Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  const Eigen::Vector2d origin = polygon.front();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i] - origin;
    const Eigen::Vector2d b = polygon[(i + 1) % polygon.size()] - origin;
    const double cross = a.x() * b.y() - a.y() * b.x();
    area += 0.5 * cross;
    first += cross / 6.0 * (a + b);
    second +=
        cross / 24.0 *
        (2.0 * a * a.transpose() + 2.0 * b * b.transpose() + a * b.transpose() + b * a.transpose());
  }
  PlaneMoments result;
  const Eigen::Vector2d centre = first / area;
  result.covariance = second / area - centre * centre.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(result.covariance);
  const Eigen::Vector2d along = axes.eigenvectors().col(1);
  result.yaw = wrapHalfTurn(std::atan2(along.y(), along.x()));
  double integral = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d x = axes.eigenvectors().transpose() * (polygon[i] - origin - centre);
    const double step = (polygon[(i + 1) % polygon.size()] - polygon[i]).norm();
    integral += x.x() * x.x() * x.y() * x.y() * step;
  }
  const double gap = axes.eigenvalues()(1) - axes.eigenvalues()(0);
  result.yaw_variance = noise * noise * correlation * integral / (area * area * gap * gap);
  return result;
}

/// What one call of detect() works on.
struct Sight {
  const StereoCamera& camera;
  const Pose& X_field_camera;
  const FragmentDetectorConfig& config;
  double pixels_per_metre;
  double area_min;  // of what is seen of a fragment in an image [px^2]
};

/// Where the line of sight of a rectified pixel meets a height.
Eigen::Vector2d onPlane(const Sight& sight, bool right, const Eigen::Vector2d& pixel,
                        double height) {
  const auto& P = right ? sight.camera.right.P : sight.camera.left.P;
  const Eigen::Vector3d ray_camera((pixel.x() - P(0, 2)) / P(0, 0), (pixel.y() - P(1, 2)) / P(1, 1),
                                   1.0);
  const Eigen::Vector3d p =
      sight.X_field_camera * Eigen::Vector3d(right ? sight.camera.baseline() : 0.0, 0.0, 0.0);
  const Eigen::Vector3d ray = sight.X_field_camera.q * ray_camera;
  return (p + ray * ((height - p.z()) / ray.z())).head<2>();
}

/// Length, width and yaw from what is seen, or from the fitted outline of what is partly hidden.
void orient(const Sight& sight, const Outline& left, const Outline& right,
            const OutlineCentre& centre, FragmentDetection& fragment) {
  const double noise = kSideNoise * sight.config.outline_noise / sight.pixels_per_metre;
  const double correlation = 4.0 / sight.pixels_per_metre;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  double yaw_variance = 0.0;
  for (const bool is_right : {false, true}) {
    std::vector<Eigen::Vector2d> polygon;
    if (fragment.partly_hidden) {
      constexpr int kPoints = 60;
      for (int i = 0; i < kPoints; ++i) {
        const double t = 2.0 * M_PI * i / kPoints;
        const double x = centre.half_length * std::cos(t);
        const double y = centre.half_width * std::sin(t);
        polygon.push_back(
            onPlane(sight, is_right,
                    {centre.pixel(is_right ? 1 : 0) + x * std::cos(centre.angle) -
                         y * std::sin(centre.angle),
                     centre.pixel(2) + x * std::sin(centre.angle) + y * std::cos(centre.angle)},
                    fragment.p_field.z()));
      }
    } else {
      for (const cv::Point& p : (is_right ? right : left).contour)
        polygon.push_back(onPlane(sight, is_right,
                                  {static_cast<double>(p.x), static_cast<double>(p.y)},
                                  fragment.p_field.z()));
    }
    // The contour runs through the centres of the outermost pixels: half a pixel is missing, which
    // concerns the size but hardly the direction.
    const PlaneMoments m = momentsOf(polygon, noise, correlation);
    covariance += 0.5 * m.covariance;
    yaw_variance += 0.5 * m.yaw_variance;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance);
  const Eigen::Vector2d along = axes.eigenvectors().col(1);
  const double pixel = 1.0 / sight.pixels_per_metre;
  fragment.yaw = wrapHalfTurn(std::atan2(along.y(), along.x()));
  fragment.yaw_deviation = std::min(
      std::sqrt(yaw_variance + kYawFloor * kYawFloor) * (fragment.partly_hidden ? 2.0 : 1.0),
      0.25 * M_PI);
  fragment.length = 4.0 * std::sqrt(std::max(0.0, axes.eigenvalues()(1))) + pixel;
  fragment.width = 4.0 * std::sqrt(std::max(0.0, axes.eigenvalues()(0))) + pixel;
}

/// The surface says something about the height of the centre, too: it lies half way down to the
/// platform, or, where the surface is higher than a piece is thick, half a piece below. One step of
/// a Kalman filter with that measurement, unless it contradicts the outlines.
void useSurface(const FragmentDetectorConfig& config, bool alone, FragmentDetection& fragment) {
  const bool on_platform = fragment.top <= config.thickness_max;
  const double z =
      on_platform ? kFlatShare * fragment.top
                  : fragment.top - kLeaning * 0.5 * (config.thickness_min + config.thickness_max);
  // What touches another one may lean on it, and is then tilted.
  const double deviation =
      kSurfaceNoise + (on_platform ? 0.07 * config.thickness_max * (alone ? 1.0 : 2.0)
                                   : 0.3 * (config.thickness_max - config.thickness_min));
  const double innovation = z - fragment.p_field.z();
  const double variance = fragment.covariance(2, 2) + deviation * deviation;
  if (innovation * innovation > kGate * kGate * variance) return;
  const Eigen::Vector3d gain = fragment.covariance.col(2) / variance;
  fragment.p_field += gain * innovation;
  fragment.covariance -= gain * fragment.covariance.row(2).eval();
}

/// One piece seen in both images; nothing where the images contradict each other or it is no
/// fragment.
std::optional<FragmentDetection> measure(const Sight& sight, const Outline& left,
                                         const Outline& right, double top) {
  const FragmentDetectorConfig& config = sight.config;
  if (left.area < sight.area_min || right.area < sight.area_min) return std::nullopt;
  FragmentDetection fragment;
  fragment.partly_hidden = std::max(left.hidden_share, right.hidden_share) > kHiddenShare;
  fragment.outline = left.contour;
  fragment.top = top;
  OutlineCentre centre = meanCentre(left, right);
  if (fragment.partly_hidden) {
    centre = fitCentre(left, right, kTypicalHalf * config.length_max * sight.pixels_per_metre,
                       kHalfDeviation * config.length_max * sight.pixels_per_metre,
                       kRoughness * sight.pixels_per_metre);
    if (!centre.converged) return std::nullopt;
    const double whole = kSuperellipseArea * centre.half_length * centre.half_width;
    if (0.5 * (left.area + right.area) < kSeenMin * whole) return std::nullopt;
  } else {
    if (std::abs(left.centre.y() - right.centre.y()) > kRowTolerance) return std::nullopt;
    const double ratio = left.area / right.area;
    if (ratio > kAreaRatio || ratio < 1.0 / kAreaRatio) return std::nullopt;
  }
  fragment.pixel = {centre.pixel(0), centre.pixel(1), centre.pixel(2)};
  const Eigen::Vector3d p_camera = sight.camera.triangulate(fragment.pixel);
  if (!(p_camera.z() > 0.0) || !p_camera.allFinite()) return std::nullopt;
  fragment.p_field = sight.X_field_camera * p_camera;
  const bool alone = left.touching_share + right.touching_share == 0.0;
  if (alone && fragment.p_field.z() < config.height_min) return std::nullopt;
  if (std::abs(fragment.p_field.x()) > 0.5 * config.field_width ||
      std::abs(fragment.p_field.y()) > 0.5 * config.field_depth)
    return std::nullopt;
  orient(sight, left, right, centre, fragment);
  const Eigen::Vector3d end(0.5 * fragment.length * std::cos(fragment.yaw),
                            0.5 * fragment.length * std::sin(fragment.yaw), 0.0);
  const StereoPixel tip =
      sight.camera.project(sight.X_field_camera.inverse() * (fragment.p_field + end));
  fragment.axis = {tip.u_left - fragment.pixel.u_left, tip.v - fragment.pixel.v};
  if (fragment.length < config.length_min || fragment.length > config.length_max)
    return std::nullopt;
  const double shape = config.shape_noise * fragment.length * sight.pixels_per_metre;
  Eigen::Matrix3d of_shape;
  of_shape << 1.0, kShapeCorrelation, 0.0, kShapeCorrelation, 1.0, 0.0, 0.0, 0.0, 1.0;
  Eigen::Matrix3d S = centre.covariance + shape * shape * of_shape;
  // Where two pieces touch, their border is where the brightness says, in each image anew.
  const double seam_left = kSeamNoise * left.touching_share * std::sqrt(left.area);
  const double seam_right = kSeamNoise * right.touching_share * std::sqrt(right.area);
  S.diagonal() +=
      Eigen::Vector3d(seam_left * seam_left, seam_right * seam_right, 0.5 * seam_left * seam_right);
  const Eigen::Matrix3d J = sight.X_field_camera.q.toRotationMatrix() *
                            sight.camera.triangulationJacobian(fragment.pixel);
  fragment.covariance = J * S * J.transpose();
  useSurface(config, alone, fragment);
  fragment.pixel = sight.camera.project(sight.X_field_camera.inverse() * fragment.p_field);
  if (fragment.p_field.z() < config.height_min || fragment.p_field.z() > config.height_max)
    return std::nullopt;
  return fragment;
}

/// From left to right in the left image is from left to right in the right one, unless they lie on
/// different heights. Of two that break this the one that is less certain goes.
void removeDisordered(std::vector<FragmentDetection>& fragments) {
  const auto disordered = [](const FragmentDetection& a, const FragmentDetection& b) {
    if (std::abs(a.pixel.v - b.pixel.v) > 5.0) return false;
    const double left = a.pixel.u_left - b.pixel.u_left;
    const double right = a.pixel.u_right - b.pixel.u_right;
    return left * right < 0.0 && std::abs(a.p_field.z() - b.p_field.z()) < kHeightAgreement;
  };
  for (std::size_t i = 0; i < fragments.size(); ++i)
    for (std::size_t j = i + 1; j < fragments.size();) {
      if (!disordered(fragments[i], fragments[j])) {
        ++j;
        continue;
      }
      if (fragments[j].covariance.trace() < fragments[i].covariance.trace())
        std::swap(fragments[i], fragments[j]);
      fragments.erase(fragments.begin() + static_cast<std::ptrdiff_t>(j));
    }
}

}  // namespace

FragmentDetector::FragmentDetector(const StereoCamera& camera, const Pose& X_field_camera,
                                   const FragmentDetectorConfig& config)
    : camera_(camera), X_field_camera_(X_field_camera), config_(config) {
  checkConfig(config);
  checkStereoCamera(camera);
  if (!isFinite(X_field_camera) || !hasUnitQuaternion(X_field_camera))
    throw InvalidInput(
        "fragment detector: the camera's pose in the field is not finite, or its "
        "quaternion is not of length 1");
  const Eigen::Vector3d middle = X_field_camera.inverse() * Eigen::Vector3d::Zero();
  if (!(X_field_camera.p.z() > config.height_max && middle.z() > 0.0))
    throw InvalidInput(
        format("fragment detector: the camera is at z = %g m of the field and the field at depth "
               "%g m, both must be above %g and 0 m; is its pose that of the left camera in the "
               "field, with z up?",
               X_field_camera.p.z(), middle.z(), config.height_max));
  makeMaps(camera.left, left_map_, left_map_fine_);
  makeMaps(camera.right, right_map_, right_map_fine_);
  const auto outlineOfField = [&](bool right) {
    std::vector<cv::Point> corners;
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      const Eigen::Vector3d p_field(x * (0.5 * config.field_width + kMargin),
                                    y * (0.5 * config.field_depth + kMargin), 0.0);
      const StereoPixel pixel = camera.project(X_field_camera.inverse() * p_field);
      corners.emplace_back(static_cast<int>(std::lround(right ? pixel.u_right : pixel.u_left)),
                           static_cast<int>(std::lround(pixel.v)));
    }
    cv::Mat inside = cv::Mat::zeros(camera.left.height, camera.left.width, CV_8UC1);
    cv::fillConvexPoly(inside, corners, cv::Scalar(255));
    if (cv::countNonZero(inside) < 1000)
      throw InvalidInput(
          format("fragment detector: the %s image shows less than 1000 px of the "
                 "field; check the pose of the cameras",
                 right ? "right" : "left"));
    return inside;
  };
  field_left_ = outlineOfField(false);
  field_right_ = outlineOfField(true);
  pixels_per_metre_ = camera.left.P(0, 0) / middle.z();
}

std::vector<FragmentDetection> FragmentDetector::detect(const cv::Mat& left, const cv::Mat& right,
                                                        FragmentDetectorTrace* trace) const {
  checkImage(left, camera_.left, "left");
  checkImage(right, camera_.right, "right");
  cv::Mat left_rect;
  cv::Mat right_rect;
  cv::remap(left, left_rect, left_map_, left_map_fine_, cv::INTER_LINEAR);
  cv::remap(right, right_rect, right_map_, right_map_fine_, cv::INTER_LINEAR);

  // Of what is less than half of the smallest one too little is known.
  const double area_whole = kWholeArea * std::pow(config_.length_min * pixels_per_metre_, 2.0);
  const double area_min = 0.5 * area_whole;
  const cv::Mat left_redness = redness(left_rect);
  const cv::Mat right_redness = redness(right_rect);
  cv::Mat left_mask = foamMask(left_redness, field_left_, config_.redness_min, area_min);
  const cv::Mat right_mask = foamMask(right_redness, field_right_, config_.redness_min, area_min);
  const PlaneSweep sweep(camera_, X_field_camera_);
  const MarkLimits marks{area_whole, config_.thickness_min, config_.height_min, config_.height_max};
  removeMarks(left_redness, right_redness, sweep, marks, left_mask);
  const cv::Mat height =
      heightMap(left_rect, right_rect, left_mask, right_mask, sweep, config_.height_max);
  PieceLimits limits;
  limits.pixels_per_metre = pixels_per_metre_;
  limits.length_max = config_.length_max;
  const FoamColour left_colour = foamColour(left_rect, left_mask);
  const FoamColour right_colour = foamColour(right_rect, right_mask);
  const cv::Mat left_labels = splitFoam(left_colour, left_mask, height, limits);
  const cv::Mat right_labels =
      transferPieces(left_labels, left_colour, height, right_colour, right_mask, sweep);
  double last = 0.0;
  cv::minMaxLoc(left_labels, nullptr, &last);
  const int pieces = static_cast<int>(last);
  const std::vector<double> tops = medians(left_labels, height, pieces);

  const std::vector<std::vector<bool>> occlusions = findOcclusions(left_labels, height, pieces);

  const Sight sight{camera_, X_field_camera_, config_, pixels_per_metre_, area_min};
  std::vector<FragmentDetection> fragments;
  for (int piece = 1; piece <= pieces; ++piece) {
    const double top = tops[static_cast<std::size_t>(piece)];
    const std::vector<bool>& hides = occlusions[static_cast<std::size_t>(piece)];
    const auto fragment =
        measure(sight, traceOutline(left_labels, piece, hides, config_.outline_noise),
                traceOutline(right_labels, piece, hides, config_.outline_noise), top);
    if (fragment) fragments.push_back(*fragment);
  }
  removeDisordered(fragments);
  std::sort(fragments.begin(), fragments.end(),
            [](const FragmentDetection& a, const FragmentDetection& b) {
              return a.p_field.x() < b.p_field.x();
            });
  if (trace != nullptr) *trace = {left_rect, right_rect, left_labels, right_labels, height};
  return fragments;
}

}  // namespace raven_correction
