// SPDX-License-Identifier: BSD-3-Clause
#include "scene_light.h"

#include <algorithm>
#include <cmath>

namespace raven_correction {
namespace {

constexpr std::size_t kLampDirections = 6;
constexpr std::size_t kRoomDirections = 7;
constexpr double kCell = 0.00025;  // of the map of the platform [m]
constexpr int kCells = 480;        // per side
constexpr double kLift = 1e-6;     // off the surface, so that it does not block itself [m]
constexpr double kBounce = 0.12;   // light that comes back from the tissue [-]

int cellOf(double x) { return static_cast<int>(std::floor(x / kCell)) + kCells / 2; }

}  // namespace

SceneLighting::SceneLighting(const DebridementScene& scene) : scene_(scene) {
  for (const FoamFragment& fragment : scene.fragments)
    X_fragment_field_.push_back(fragment.X_field_fragment.inverse());
  const Eigen::Vector3d lamp = scene.light.lamp_direction.normalized();
  const Eigen::Vector3d side = lamp.unitOrthogonal();
  const Eigen::Vector3d other = lamp.cross(side);
  for (std::size_t k = 0; k < kLampDirections; ++k) {  // a spiral over the disc of the lamp
    const double radius = std::sqrt((static_cast<double>(k) + 0.5) / kLampDirections);
    const double angle = 2.399963 * static_cast<double>(k);
    const Eigen::Vector3d offset =
        scene.light.lamp_size * radius * (std::cos(angle) * side + std::sin(angle) * other);
    directions_.push_back((lamp + offset).normalized());
    weights_.push_back(scene.light.lamp / kLampDirections);
  }
  // Over the hemisphere so that, without anything in the way, the platform gets `room`.
  for (std::size_t k = 0; k < kRoomDirections; ++k) {
    const double z = std::sqrt(1.0 - (static_cast<double>(k) + 0.5) / kRoomDirections);
    const double angle = 2.399963 * static_cast<double>(k) + 0.5;
    const double radius = std::sqrt(1.0 - z * z);
    directions_.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    weights_.push_back(scene.light.room / (kRoomDirections * z));
  }
  for (std::size_t k = 0; k < directions_.size(); ++k) open_ += directions_[k].z() * weights_[k];
  platform_.assign(static_cast<std::size_t>(kCells * kCells), 0);
  for (std::size_t body = 0; body < scene.fragments.size(); ++body) shadePlatform(body);
}

bool SceneLighting::blocked(const Eigen::Vector3d& p_field, std::size_t direction,
                            std::size_t body) const noexcept {
  const FoamFragment& fragment = scene_.fragments[body];
  const Eigen::Vector3d gap = fragment.X_field_fragment.p - p_field;
  const Eigen::Vector3d& d = directions_[direction];
  const double along = gap.dot(d);
  const double r2 = fragment.radius * fragment.radius;
  if (gap.squaredNorm() - along * along >= r2 || along < -fragment.radius) return false;
  const Pose& X = X_fragment_field_[body];
  return fragment.hit(X * p_field, X.q * d).has_value();
}

void SceneLighting::shadePlatform(std::size_t body) {
  const FoamFragment& fragment = scene_.fragments[body];
  const Eigen::Vector3d& p = fragment.X_field_fragment.p;
  for (std::size_t k = 0; k < directions_.size(); ++k) {
    const Eigen::Vector3d& d = directions_[k];
    const Eigen::Vector2d middle = p.head<2>() - d.head<2>() * (p.z() / d.z());
    const double reach = fragment.radius / d.z();
    const int i1 = std::min(cellOf(middle.y() + reach), kCells - 1);
    const int j1 = std::min(cellOf(middle.x() + reach), kCells - 1);
    for (int i = std::max(cellOf(middle.y() - reach), 0); i <= i1; ++i)
      for (int j = std::max(cellOf(middle.x() - reach), 0); j <= j1; ++j) {
        const Eigen::Vector3d q((j - kCells / 2 + 0.5) * kCell, (i - kCells / 2 + 0.5) * kCell,
                                kLift);
        if (blocked(q, k, body))
          platform_[static_cast<std::size_t>(i * kCells + j)] |= Mask{1} << k;
      }
  }
}

Eigen::Vector3d SceneLighting::onPlatform(double x, double y) const noexcept {
  // Bilinear between the centres of four cells.
  const double fx = x / kCell + kCells / 2 - 0.5;
  const double fy = y / kCell + kCells / 2 - 0.5;
  const int j = static_cast<int>(std::floor(fx));
  const int i = static_cast<int>(std::floor(fy));
  Mask masks[4] = {0, 0, 0, 0};
  if (i >= 0 && j >= 0 && i + 1 < kCells && j + 1 < kCells) {
    const Mask* const cell = platform_.data() + i * kCells + j;
    masks[0] = cell[0];
    masks[1] = cell[1];
    masks[2] = cell[kCells];
    masks[3] = cell[kCells + 1];
  }
  if ((masks[0] | masks[1] | masks[2] | masks[3]) == 0) return open_;
  const double s = fx - j;
  const double t = fy - i;
  const double shares[4] = {(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t};
  Eigen::Vector3d light = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < directions_.size(); ++k) {
    double share = 0.0;
    for (int m = 0; m < 4; ++m)
      if ((masks[m] >> k & 1u) == 0) share += shares[m];
    light += share * directions_[k].z() * weights_[k];
  }
  return light;
}

double SceneLighting::lampOnPlatform(double x, double y) const noexcept {
  const int i = cellOf(y);
  const int j = cellOf(x);
  if (i < 0 || j < 0 || i >= kCells || j >= kCells) return 1.0;
  const Mask mask = platform_[static_cast<std::size_t>(i * kCells + j)];
  int free = 0;
  for (std::size_t k = 0; k < kLampDirections; ++k) free += (mask >> k & 1u) == 0;
  return static_cast<double>(free) / kLampDirections;
}

Eigen::Vector3d SceneLighting::onFragment(std::size_t fragment, const Eigen::Vector3d& p_field,
                                          const Eigen::Vector3d& normal_field) const noexcept {
  const Eigen::Vector3d p = p_field + kLift * normal_field;
  Eigen::Vector3d light = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < directions_.size(); ++k) {
    const double cosine = normal_field.dot(directions_[k]);
    if (cosine <= 0.0) continue;
    bool free = true;
    for (std::size_t body = 0; body < scene_.fragments.size() && free; ++body)
      free = body == fragment || !blocked(p, k, body);
    if (free) light += cosine * weights_[k];
  }
  const Eigen::Vector3d all =
      scene_.light.lamp * scene_.light.lamp_direction.z() + scene_.light.room;
  return light + kBounce * 0.5 * (1.0 - normal_field.z()) * all.cwiseProduct(scene_.tissue);
}

}  // namespace raven_correction
