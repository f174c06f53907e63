// SPDX-License-Identifier: BSD-3-Clause
// Where the red foam fragments of a debridement field are, how they are turned and how sure that
// is, from one pair of images of a calibrated stereo camera. It knows of fragments no more than the
// configuration says, and keeps nothing from one pair to the next.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "raven_correction/geometry/pose.h"
#include "raven_correction/geometry/stereo_camera.h"

namespace raven_correction {

struct FragmentDetectorConfig {
  double field_width = 0.08;     ///< of the field along its x [m]; what lies outside is ignored
  double field_depth = 0.08;     ///< along its y [m]
  double height_min = 0.001;     ///< of a fragment's centre above the platform
  double height_max = 0.015;     ///< [m]
  double length_min = 0.0063;    ///< of a fragment's outline from above [m]
  double length_max = 0.016;     ///< a longer one is split or refused [m]
  double thickness_min = 0.003;  ///< of a fragment as it lies flat [m]
  double thickness_max = 0.006;  ///< what is higher lies on another one [m]
  double redness_min = 0.3;    ///< redder than the tissue, in logarithm of red over green and blue
  double outline_noise = 0.6;  ///< of a point of an outline, one standard deviation [px]
  double shape_noise = 0.015;  ///< how far the middle of an outline is from the projected centre of
                               ///< the body, per length of the fragment, one deviation [-]
};

struct FragmentDetection {
  Eigen::Vector3d p_field = Eigen::Vector3d::Zero();     ///< centre of the volume [m]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of p_field [m^2]
  double yaw = 0.0;            ///< of the long axis of the outline about z, (-pi/2, pi/2] [rad]
  double yaw_deviation = 0.0;  ///< one standard deviation [rad]; large for a round fragment
  double length = 0.0;         ///< 4 standard deviations of the outline from above, along [m]
  double width = 0.0;          ///< and across the long axis [m]
  double top = 0.0;            ///< median height of what is seen of it above the platform [m]
  bool partly_hidden = false;  ///< something lies on it: its centre is that of a fitted outline
  StereoPixel pixel;           ///< of its centre in the rectified images
  cv::Point2d axis;  ///< from the centre to the end of the long axis, in the left one [px]
  std::vector<cv::Point> outline;  ///< of what is seen of it in the rectified left image [px]
};

/// What detect() saw on the way, for pictures and for the curious.
struct FragmentDetectorTrace {
  cv::Mat left, right;                ///< rectified, 8UC3
  cv::Mat left_labels, right_labels;  ///< 32SC1: 1, 2, ... a piece, 0 none
  cv::Mat height;                     ///< 32FC1 above the platform, where foam is seen [m]
};

/// 1. Both images are rectified: lens removed, rows are epipolar lines.
/// 2. Colour: log red over green and blue, relative to the median of the field, so that neither
///    shadow nor exposure nor white balance counts; the limit is half way to the median of foam.
/// 3. Height: a red region that fits the right image best on the platform is no foam, nor is one
/// too
///    small for a fragment and half of another that is not convex or seems lower than 0.22 of
///    thickness_min; elsewhere the left image is matched with the right one as planes at
///    many heights would show it.
/// 4. Pieces: a watershed cuts foam into small ones, and those that are one fragment are joined
///    again, by colour, height, seam and shape; the weights of these cues are trained.
/// 5. Each piece is found again in the right image on the same rows, by its height, and cut out
///    there likewise. Rows, sizes, order and height have to agree.
/// 6. The centre of each outline is triangulated: of a fitted one where another piece hides a part.
///
/// Uncertainty: an outline is displaced by s_b = outline_noise, correlated over c = 4 px, so the
/// centre of its area A is off by (variance per image axis, x from the centre)
///
///   s^2 = (s_b^2 c / A^2) (closed integral of x^2 ds)
///
/// and where it is fitted, by (sum J^T J / s_f^2 + prior)^-1. To this covariance of (u_left,
/// u_right, v) the shape adds (shape_noise length in px)^2, correlated by 0.9 between both images,
/// because both see nearly the same, and a seam with another piece (0.12 share sqrt(A))^2 in each.
/// With the sum S, J the Jacobian of triangulation and R = R_field_camera,
///
///   covariance = R J S J^T R^T.
///
/// The height t of the surface is a second measurement of the centre's height: 0.55 t on the
/// platform (t <= thickness_max), else t less 0.37 times the mean thickness. It is taken in by one
/// step of a Kalman filter unless it is more than 3.5 deviations away.
///
/// No member is written after the constructor, so several threads may use one detector.
class FragmentDetector {
 public:
  /// @param X_field_camera  of the left `rect` frame; the field has its origin in the middle of the
  ///                        platform's surface, z up
  /// @throws InvalidInput  see checkStereoCamera(); a configuration out of range; cameras that
  ///         stand below the platform or do not see the field
  FragmentDetector(const StereoCamera& camera, const Pose& X_field_camera,
                   const FragmentDetectorConfig& config);

  /// @param left, right  raw images, 8UC3, blue green red, of the cameras' size
  /// @param trace        filled if given
  /// @return sorted by x
  /// @throws InvalidInput  an image that is empty, of another type or another size than its
  /// camera's
  std::vector<FragmentDetection> detect(const cv::Mat& left, const cv::Mat& right,
                                        FragmentDetectorTrace* trace = nullptr) const;

  const StereoCamera& camera() const noexcept { return camera_; }

 private:
  StereoCamera camera_;
  Pose X_field_camera_;
  FragmentDetectorConfig config_;
  cv::Mat left_map_, left_map_fine_, right_map_, right_map_fine_;  // of cv::remap
  cv::Mat field_left_, field_right_;  // 8UC1: where the field is seen, rectified
  double pixels_per_metre_ = 0.0;     // in the middle of the field
};

}  // namespace raven_correction
