// SPDX-License-Identifier: BSD-3-Clause
// The body of one piece of cut foam: an irregular rounded block or blob in its own frame, with a
// pose on the field. A whole field of them with its light is debridement_scene.h.
#pragma once

#include <array>
#include <optional>
#include <random>
#include <vector>

#include "raven_correction/geometry/pose.h"

namespace raven_correction {

/// The set of points with inside() < 0, in the frame of the fragment (z up as it lies flat), with
/// q = p / half_size component by component and the angle t of (qx, qy):
///
///   g(t) = 1 + sum_n c_n cos(n t) + s_n sin(n t), n = 2, 3, 5    (an irregular outline)
///   F = (|qx|^e + |qy|^e) / g(t)^e + |qz|^e - 1                  (e = 2 a blob, 8 nearly a block)
///
/// and of it what lies below planes n.q = d (cuts of the knife).
struct FoamFragment {
  struct Cut {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  ///< of q, unit
    double offset = 1.0;                                ///< d, in (0.5, 1]
  };
  Pose X_field_fragment;
  Eigen::Vector3d half_size{0.004, 0.003, 0.002};  ///< [m]
  int exponent = 4;                                ///< e: 2, 4, 6 or 8
  std::array<double, 3> cosine{};                  ///< c_n; their sizes sum up to less than 0.3
  std::array<double, 3> sine{};                    ///< s_n, likewise together with c_n
  std::vector<Cut> cuts;
  Eigen::Vector3d albedo{0.6, 0.05, 0.06};  ///< red, green, blue: linear, in [0, 1]
  double grain = 0.1;                       ///< relative deviation of the albedo by the pores [-]
  double grain_size = 0.0006;               ///< of a pore [m]
  Eigen::Vector2d grain_offset{0.0, 0.0};   ///< where in the pattern of pores it was cut [m]

  // What finish() computes of the above.
  double radius = 0.0;  ///< of a ball about the origin that holds the body [m]
  Eigen::Vector3d p_fragment_centre = Eigen::Vector3d::Zero();  ///< centre of the volume [m]

  /// F, or how far beyond a cut; < 0 inside. Its size is no distance.
  double inside(const Eigen::Vector3d& p_fragment) const noexcept;
  /// Outward unit normal at a point of the surface, in the frame of the fragment.
  Eigen::Vector3d normal(const Eigen::Vector3d& p_fragment) const noexcept;
  /// Where a ray first meets the body: the smallest t > 0 of origin + t direction; nothing if it
  /// passes. Pieces thinner than a tenth of the way through the ball can be missed.
  std::optional<double> hit(const Eigen::Vector3d& p_fragment_origin,
                            const Eigen::Vector3d& direction) const noexcept;
  void finish();
};

/// What a fragment measures seen from above, and where its middle is.
struct FragmentTruth {
  Eigen::Vector3d p_field = Eigen::Vector3d::Zero();  ///< centre of the volume [m]
  double yaw = 0.0;  ///< of the long axis of the outline from above, about z, (-pi/2, pi/2] [rad]
  double length = 0.0;  ///< 4 standard deviations of the outline along that axis [m]: of an ellipse
  double width = 0.0;   ///< its axes; likewise across
};
/// By summing over a grid of points.
FragmentTruth measureFragment(const FoamFragment& fragment);

struct FoamShapeConfig {
  double length_min = 0.007;      ///< along the longer side, before cuts [m]
  double length_max = 0.012;      ///< [m]
  double slenderness_min = 0.55;  ///< width / length
  double slenderness_max = 1.0;
  double height_min = 0.003;  ///< [m]
  double height_max = 0.006;  ///< [m]
};
/// A random piece at the origin of the field; the caller lays it down.
FoamFragment cutFoam(const FoamShapeConfig& config, std::mt19937_64& random);

}  // namespace raven_correction
