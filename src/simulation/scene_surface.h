// SPDX-License-Identifier: BSD-3-Clause
// The colour in which a point of a debridement scene is seen: tissue with its marks and highlights,
// the drape around it, foam with its pores. The light that arrives there is scene_light.h.
#pragma once

#include "scene_light.h"

namespace raven_correction {

class SceneSurface {
 public:
  /// Keep references.
  SceneSurface(const DebridementScene& scene, const SceneLighting& lighting);

  /// Linear red, green, blue of a point of the platform.
  /// @param towards  from the point to the camera, unit
  Eigen::Vector3d platform(double x, double y, const Eigen::Vector3d& towards) const noexcept;
  Eigen::Vector3d foam(std::size_t fragment, const Eigen::Vector3d& p_field) const noexcept;

 private:
  Eigen::Vector3d tissueAlbedo(double x, double y, double u, double v) const noexcept;

  const DebridementScene& scene_;
  const SceneLighting& lighting_;
  double cosine_;  // of the direction of the pattern
  double sine_;
};

}  // namespace raven_correction
