// SPDX-License-Identifier: BSD-3-Clause
// How much light arrives at a point of a debridement scene: a few directions stand for the lamp and
// for the room, and fragments block them. What the surfaces make of it is scene_surface.h.
#pragma once

#include <cstdint>
#include <vector>

#include "raven_correction/simulation/debridement_scene.h"

namespace raven_correction {

class SceneLighting {
 public:
  /// Keeps a reference to the scene.
  explicit SceneLighting(const DebridementScene& scene);

  /// Light on the platform, from a map made once. @return linear red, green, blue
  Eigen::Vector3d onPlatform(double x, double y) const noexcept;
  /// Share of the lamp that a point of the platform sees, in [0, 1].
  double lampOnPlatform(double x, double y) const noexcept;
  /// Light on a fragment. Fragments are taken for convex: none shades itself.
  /// @param fragment  index of the one the point belongs to
  Eigen::Vector3d onFragment(std::size_t fragment, const Eigen::Vector3d& p_field,
                             const Eigen::Vector3d& normal_field) const noexcept;

 private:
  using Mask = std::uint32_t;  // bit k: direction k is blocked
  bool blocked(const Eigen::Vector3d& p_field, std::size_t direction,
               std::size_t body) const noexcept;
  void shadePlatform(std::size_t body);

  const DebridementScene& scene_;
  std::vector<Pose> X_fragment_field_;
  std::vector<Eigen::Vector3d> directions_;         // to the light: lamp first, then room
  std::vector<Eigen::Vector3d> weights_;            // irradiance across each direction
  std::vector<Mask> platform_;                      // blocked directions per cell
  Eigen::Vector3d open_ = Eigen::Vector3d::Zero();  // light where nothing is in the way
};

}  // namespace raven_correction
