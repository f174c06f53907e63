// SPDX-License-Identifier: BSD-3-Clause
// The two raw images that a stereo camera takes of a scene (debridement_scene.h), through its
// lenses, with soft shadows and noise; and the truth about every fragment in it.
#pragma once

#include <cstdint>
#include <vector>

#include "raven_correction/simulation/debridement_scene.h"

namespace raven_correction {

/// Rows from the top, pixels from the left, blue green red: what OpenCV and `bgr8` call an image.
struct ColourImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> bgr;  ///< 3 width height
};

struct VisibleFragment {
  FragmentTruth truth;
  /// Pixels in which it is seen, per pixels in which it would be seen if it lay there alone; 0
  /// where it is outside the image.
  double visible_left = 0.0;
  double visible_right = 0.0;
};

struct StereoPicture {
  ColourImage left;
  ColourImage right;
  std::vector<VisibleFragment> fragments;  ///< in the order of the scene
};

/// The light that falls on both sensors: what one frame of a scene at rest shares with the next.
struct StereoExposure {
  int width = 0;
  int height = 0;
  std::vector<Eigen::Vector3f> left;   ///< linear red, green, blue, row by row
  std::vector<Eigen::Vector3f> right;  ///< likewise
  SceneSensor sensor;
  std::vector<VisibleFragment> fragments;  ///< in the order of the scene
};
/// What the sensors make of it: gain, vignetting, blur, noise, 8 bits.
/// @param noise_seed  another one is another frame
StereoPicture develop(const StereoExposure& exposure, std::uint64_t noise_seed);

/// Renders what one rig sees. Every pixel is one ray through the lens, and five where something
/// begins or ends; lamp and room are a handful of directions each, that other fragments can block.
class StereoRenderer {
 public:
  /// @throws InvalidInput  see checkStereoCamera()
  explicit StereoRenderer(const StereoCamera& camera);

  /// @param X_field_camera  of the left `rect` frame
  StereoExposure expose(const DebridementScene& scene, const Pose& X_field_camera) const;

 private:
  StereoCamera camera_;
  std::vector<Eigen::Vector3f> left_rays_;   // of the pixels' centres, in `rect`
  std::vector<Eigen::Vector3f> right_rays_;  // likewise
};

}  // namespace raven_correction
