// SPDX-License-Identifier: BSD-3-Clause
#include "scene_surface.h"

#include <algorithm>
#include <cmath>

#include "noise_pattern.h"

namespace raven_correction {
namespace {

constexpr double kPeriod = 0.08;                             // of the coarse pattern [m]
constexpr double kPerMetre = NoisePattern::kSize / kPeriod;  // values of it [1/m]
constexpr double kVesselWidth = 0.10;  // about a zero of the pattern, in deviations of it
constexpr double kFatLevel = 1.5;      // deviations of the pattern above which there is fat
constexpr double kBumps = 0.10;        // slope of the wet surface, per deviation
constexpr double kFoamShine = 0.02;

double ramp(double x, double from, double to) {
  return std::clamp((x - from) / (to - from), 0.0, 1.0);
}

double power64(double x) {
  for (int i = 0; i < 6; ++i) x *= x;
  return x;
}

Eigen::Vector3d mix(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double share) {
  return a + share * (b - a);
}

}  // namespace

SceneSurface::SceneSurface(const DebridementScene& scene, const SceneLighting& lighting)
    : scene_(scene),
      lighting_(lighting),
      cosine_(std::cos(scene.pattern.z())),
      sine_(std::sin(scene.pattern.z())) {}

Eigen::Vector3d SceneSurface::tissueAlbedo(double x, double y, double u, double v) const noexcept {
  const NoisePattern& coarse = coarsePattern();
  const double mottle = coarse.at(u, v);
  Eigen::Vector3d albedo = scene_.tissue * std::max(0.3, 1.0 + scene_.mottle * mottle);
  const double fat = coarse.at(0.6 * v + 311.0, 0.6 * u + 97.0);
  albedo = mix(albedo, scene_.fat, ramp(fat, kFatLevel, kFatLevel + 0.3));
  const double vessel = coarse.at(0.35 * u + 171.0, 0.35 * v + 23.0);
  albedo =
      mix(albedo, scene_.vessel, 0.8 * ramp(std::abs(vessel), kVesselWidth, 0.4 * kVesselWidth));
  for (const Stain& stain : scene_.stains) {
    const Eigen::Vector2d d = Eigen::Vector2d(x, y) - stain.centre;
    const double c = std::cos(stain.yaw);
    const double s = std::sin(stain.yaw);
    const Eigen::Vector2d q = Eigen::Vector2d(c * d.x() + s * d.y(), c * d.y() - s * d.x())
                                  .cwiseQuotient(stain.half_size);
    if (q.squaredNorm() > 2.0) continue;
    const double edge = q.norm() + 0.15 * coarse.at(2.0 * u, 2.0 * v);
    albedo = mix(albedo, stain.albedo, ramp(edge, 1.0, 0.85));
  }
  return albedo;
}

Eigen::Vector3d SceneSurface::platform(double x, double y,
                                       const Eigen::Vector3d& towards) const noexcept {
  const Eigen::Vector3d light = lighting_.onPlatform(x, y);
  const double u = kPerMetre * (cosine_ * (x + scene_.pattern.x()) - sine_ * y);
  const double v = kPerMetre * (sine_ * x + cosine_ * (y + scene_.pattern.y()));
  const NoisePattern& fine = finePattern();
  const double half = scene_.tissue_half_size;
  if (std::abs(x) > half || std::abs(y) > half)
    return light.cwiseProduct(scene_.drape) * (1.0 + 0.1 * fine.at(0.5 * u, 0.5 * v));
  Eigen::Vector3d colour = light.cwiseProduct(tissueAlbedo(x, y, u, v));
  const Eigen::Vector3d normal(kBumps * coarsePattern().at(1.7 * u + 61.0, 1.7 * v),
                               kBumps * coarsePattern().at(1.7 * v + 203.0, 1.7 * u), 1.0);
  const Eigen::Vector3d middle = (scene_.light.lamp_direction + towards).normalized();
  const double glance = normal.dot(middle) / normal.norm();
  if (glance > 0.9)
    colour += (2.0 * scene_.wetness * power64(glance) * lighting_.lampOnPlatform(x, y)) *
              scene_.light.lamp;
  return colour;
}

Eigen::Vector3d SceneSurface::foam(std::size_t index,
                                   const Eigen::Vector3d& p_field) const noexcept {
  const FoamFragment& fragment = scene_.fragments[index];
  const Eigen::Vector3d p = fragment.X_field_fragment.inverse() * p_field;
  const Eigen::Vector3d normal = fragment.X_field_fragment.q * fragment.normal(p);
  const Eigen::Vector3d light = lighting_.onFragment(index, p_field, normal);
  // Pores go through the whole piece: a pattern of x and y, shifted with z. A feature of the fine
  // pattern is two values wide.
  const double scale = 2.0 / fragment.grain_size;
  const double u = scale * (p.x() + 0.83 * p.z() + fragment.grain_offset.x());
  const double v = scale * (p.y() - 0.71 * p.z() + fragment.grain_offset.y());
  const double pores = fragment.grain * (0.8 * finePattern().at(u, v) +
                                         0.6 * coarsePattern().at(0.35 * u, 0.35 * v));
  return light.cwiseProduct(fragment.albedo) * std::max(0.2, 1.0 + pores) + kFoamShine * light;
}

}  // namespace raven_correction
