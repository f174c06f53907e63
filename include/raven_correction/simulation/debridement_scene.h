// SPDX-License-Identifier: BSD-3-Clause
// What lies on the field and in what light: foam fragments, some on top of others, tissue with
// vessels, fat and stains, lamps, exposure and noise; all drawn from a seed. The pictures of it are
// made by stereo_renderer.h.
#pragma once

#include <cstdint>
#include <vector>

#include "raven_correction/simulation/foam_fragment.h"
#include "raven_correction/simulation/stereo_rig.h"

namespace raven_correction {

/// A flat mark on the tissue. A blood stain has the colour of the foam but no height.
struct Stain {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();         ///< in the field [m]
  Eigen::Vector2d half_size{0.003, 0.002};                  ///< [m]
  double yaw = 0.0;                                         ///< [rad]
  Eigen::Vector3d albedo = Eigen::Vector3d::Constant(0.5);  ///< linear red, green, blue
};

/// Colours are linear red, green, blue.
struct SceneLight {
  Eigen::Vector3d lamp_direction{0.3, 0.2, 0.93};  ///< from the field to the lamp, unit
  double lamp_size = 0.08;                         ///< half angle of the lamp: soft shadows [rad]
  Eigen::Vector3d lamp{0.8, 0.8, 0.8};             ///< irradiance across its direction
  Eigen::Vector3d room{0.3, 0.3, 0.3};             ///< irradiance from all around
};

struct SceneSensor {
  Eigen::Vector3d gain{1.0, 1.0, 1.0};  ///< exposure times white balance
  double vignetting = 0.2;              ///< loss of light in the corners [-]
  double blur = 0.15;                   ///< share of a pixel's light that each neighbour gets [-]
  double shot_noise = 1e-4;             ///< variance per unit of linear signal [-]
  double read_noise = 3e-3;             ///< standard deviation, linear [-]
};

/// The field has its origin in the middle of the platform's surface, z up.
struct DebridementScene {
  std::vector<FoamFragment> fragments;  ///< in the order in which they were laid down
  std::vector<Stain> stains;
  double tissue_half_size = 0.05;            ///< of the square of tissue [m]
  Eigen::Vector3d tissue{0.75, 0.42, 0.40};  ///< albedo
  Eigen::Vector3d vessel{0.50, 0.20, 0.18};  ///< albedo
  Eigen::Vector3d fat{0.80, 0.65, 0.40};     ///< albedo
  Eigen::Vector3d drape{0.10, 0.25, 0.30};   ///< albedo of what lies around the tissue
  Eigen::Vector3d pattern{0.0, 0.0, 0.0};    ///< where the patterns begin [m, m, rad]
  double mottle = 0.12;                      ///< relative deviation of the tissue's albedo
  double wetness = 0.5;                      ///< strength of its highlights
  SceneLight light;
  SceneSensor sensor;
};

struct DebridementSceneConfig {
  int fragments_min = 3;
  int fragments_max = 9;
  double field_size = 0.08;      ///< fragments lie inside this square [m]
  double neighbour_share = 0.4;  ///< of the fragments are laid against or onto another one
  double clearance = 0.0008;     ///< between the others [m]
  int stains_max = 2;            ///< blood stains that do not touch a fragment
  FoamShapeConfig foam;
};

/// Deterministic. Fragments that find no room are left out.
/// @throws InvalidInput  a range that is empty or negative
DebridementScene makeDebridementScene(const DebridementSceneConfig& config, std::uint64_t seed);

/// A rig that stands a little elsewhere with every seed: distance, tilt, azimuth.
StereoRigConfig variedRig(const StereoRigConfig& config, std::uint64_t seed);

}  // namespace raven_correction
