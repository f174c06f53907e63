// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/stereo_renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "scene_light.h"
#include "scene_surface.h"

namespace raven_correction {
namespace {

constexpr int kNothing = -1;    // index where the platform is seen
constexpr int kRaySpacing = 8;  // of the rays that are computed exactly [px]
constexpr int kLevels = 4096;   // of the table that encodes linear light
constexpr std::size_t kNoise = 1 << 16;

/// A raw image of linear light while it is made.
struct Film {
  int width;
  int height;
  std::vector<Eigen::Vector3f> light;  // red, green, blue
  std::vector<int> seen;               // index of the fragment, or kNothing
  std::vector<float> distance;         // along the ray to it

  Film(int w, int h)
      : width(w),
        height(h),
        light(static_cast<std::size_t>(w * h), Eigen::Vector3f::Zero()),
        seen(light.size(), kNothing),
        distance(light.size(), std::numeric_limits<float>::infinity()) {}
  std::size_t at(int u, int v) const { return static_cast<std::size_t>(v * width + u); }
};

/// One camera's view of a scene.
class View {
 public:
  View(const DebridementScene& scene, const SceneSurface& surface, const PinholeCamera& camera,
       const Pose& X_field_camera, const std::vector<Eigen::Vector3f>& rays)
      : scene_(scene), surface_(surface), camera_(camera), X_(X_field_camera), rays_(rays) {
    R_ = X_.q.toRotationMatrix();
    for (const FoamFragment& fragment : scene.fragments)
      X_fragment_field_.push_back(fragment.X_field_fragment.inverse());
  }

  /// @param alone  pixels in which each fragment would be seen if it were alone
  Film expose(std::vector<double>& alone) const {
    Film film(camera_.width, camera_.height);
    alone.assign(scene_.fragments.size(), 0.0);
    for (std::size_t k = 0; k < scene_.fragments.size(); ++k) alone[k] = mark(k, film);
    for (std::size_t i = 0; i < film.light.size(); ++i)
      film.light[i] = colour(R_ * rays_[i].cast<double>(), film.seen[i], film.distance[i]);
    smoothEdges(film);
    return film;
  }

 private:
  /// Enters one fragment wherever it is in front of what is there. @return pixels it covers
  double mark(std::size_t k, Film& film) const {
    const FoamFragment& fragment = scene_.fragments[k];
    const Eigen::Vector3d p_camera = X_.inverse() * fragment.X_field_fragment.p;
    if (p_camera.z() <= fragment.radius) return 0.0;
    const Eigen::Vector2d middle = camera_.rawPixel(p_camera);
    const double reach =
        1.15 * camera_.K(0, 0) * fragment.radius / (p_camera.z() - fragment.radius);
    const int u0 = std::max(0, static_cast<int>(middle.x() - reach) - 2);
    const int v0 = std::max(0, static_cast<int>(middle.y() - reach) - 2);
    const int u1 = std::min(film.width - 1, static_cast<int>(middle.x() + reach) + 2);
    const int v1 = std::min(film.height - 1, static_cast<int>(middle.y() + reach) + 2);
    double covered = 0.0;
    for (int v = v0; v <= v1; ++v)
      for (int u = u0; u <= u1; ++u) {
        const std::size_t i = film.at(u, v);
        const auto t = meet(k, R_ * rays_[i].cast<double>());
        if (!t) continue;
        covered += 1.0;
        if (*t >= film.distance[i]) continue;
        film.distance[i] = static_cast<float>(*t);
        film.seen[i] = static_cast<int>(k);
      }
    return covered;
  }

  std::optional<double> meet(std::size_t k, const Eigen::Vector3d& ray) const {
    const Pose& X = X_fragment_field_[k];
    return scene_.fragments[k].hit(X * X_.p, X.q * ray);
  }

  Eigen::Vector3f colour(const Eigen::Vector3d& ray, int seen, double distance) const {
    if (seen != kNothing)
      return surface_.foam(static_cast<std::size_t>(seen), X_.p + distance * ray).cast<float>();
    if (ray.z() >= -1e-6) return Eigen::Vector3f::Zero();  // above the horizon: dark room
    const Eigen::Vector3d p = X_.p - (X_.p.z() / ray.z()) * ray;
    return surface_.platform(p.x(), p.y(), -ray).cast<float>();
  }

  /// Four more rays where a pixel and its neighbours show different things.
  void smoothEdges(Film& film) const {
    constexpr double kOffsets[4][2] = {
        {-0.375, -0.125}, {0.125, -0.375}, {0.375, 0.125}, {-0.125, 0.375}};
    for (int v = 1; v + 1 < film.height; ++v)
      for (int u = 1; u + 1 < film.width; ++u) {
        const int here = film.seen[film.at(u, v)];
        int around[4] = {film.seen[film.at(u - 1, v)], film.seen[film.at(u + 1, v)],
                         film.seen[film.at(u, v - 1)], film.seen[film.at(u, v + 1)]};
        if (std::all_of(around, around + 4, [here](int k) { return k == here; })) continue;
        Eigen::Vector3f sum = film.light[film.at(u, v)];
        for (const auto& offset : kOffsets) {
          const Eigen::Vector3d ray = R_ * camera_.rayOf({u + offset[0], v + offset[1]});
          int seen = kNothing;
          double nearest = std::numeric_limits<double>::infinity();
          const auto consider = [&](int k) {
            if (k == kNothing || k == seen) return;
            const auto t = meet(static_cast<std::size_t>(k), ray);
            if (!t || *t >= nearest) return;
            nearest = *t;
            seen = k;
          };
          consider(here);
          for (const int k : around) consider(k);
          sum += colour(ray, seen, nearest);
        }
        film.light[film.at(u, v)] = sum / 5.0f;
      }
  }

  const DebridementScene& scene_;
  const SceneSurface& surface_;
  const PinholeCamera& camera_;
  Pose X_;
  Eigen::Matrix3d R_;
  const std::vector<Eigen::Vector3f>& rays_;
  std::vector<Pose> X_fragment_field_;
};

/// Linear light to 8 bits as sRGB cameras do it.
const std::vector<std::uint8_t>& encoding() {
  static const std::vector<std::uint8_t> table = [] {
    std::vector<std::uint8_t> values;
    for (int i = 0; i <= kLevels; ++i) {
      const double x = static_cast<double>(i) / kLevels;
      const double y = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
      values.push_back(static_cast<std::uint8_t>(std::lround(255.0 * y)));
    }
    return values;
  }();
  return table;
}

/// Normal numbers made once; a sensor starts somewhere in them for every row.
const std::vector<float>& normalNumbers() {
  static const std::vector<float> numbers = [] {
    std::mt19937 random(3);
    std::normal_distribution<float> normal;
    std::vector<float> values(kNoise);
    for (float& value : values) value = normal(random);
    return values;
  }();
  return numbers;
}

/// Vignetting, blur, gain, noise, encoding of one image.
ColourImage developOne(const std::vector<Eigen::Vector3f>& light, int width, int height,
                       const SceneSensor& sensor, std::uint64_t seed) {
  ColourImage image{width, height, {}};
  image.bgr.resize(3 * light.size());
  const std::vector<std::uint8_t>& table = encoding();
  const std::vector<float>& normal = normalNumbers();
  std::mt19937_64 random(seed);
  const auto blur = static_cast<float>(sensor.blur / (1.0 + 4.0 * sensor.blur));
  const float keep = 1.0f - 4.0f * blur;
  const Eigen::Vector3f gain = sensor.gain.cast<float>();
  const auto shot = static_cast<float>(sensor.shot_noise);
  const auto read = static_cast<float>(sensor.read_noise * sensor.read_noise);
  const double corner2 = 0.25 * (width * width + height * height);
  const auto at = [&](int u, int v) -> const Eigen::Vector3f& {
    return light[static_cast<std::size_t>(std::clamp(v, 0, height - 1) * width +
                                          std::clamp(u, 0, width - 1))];
  };
  for (int v = 0; v < height; ++v) {
    std::uint64_t noise = random();
    for (int u = 0; u < width; ++u) {
      const double du = u - 0.5 * width;
      const double dv = v - 0.5 * height;
      const auto fall = static_cast<float>(1.0 - sensor.vignetting * (du * du + dv * dv) / corner2);
      const Eigen::Vector3f around = at(u - 1, v) + at(u + 1, v) + at(u, v - 1) + at(u, v + 1);
      const Eigen::Vector3f signal = (fall * (keep * at(u, v) + blur * around)).cwiseProduct(gain);
      std::uint8_t* const pixel = image.bgr.data() + 3 * (v * width + u);
      for (int c = 0; c < 3; ++c) {
        const float mean = signal(2 - c);
        const float noisy = mean + std::sqrt(read + shot * mean) * normal[noise++ & (kNoise - 1)];
        const int level = static_cast<int>(std::clamp(noisy, 0.0f, 1.0f) * kLevels + 0.5f);
        pixel[c] = table[static_cast<std::size_t>(level)];
      }
    }
  }
  return image;
}

/// Exactly at every kRaySpacing-th pixel, bilinear between: a lens bends by less than a hundredth
/// of a pixel over that.
std::vector<Eigen::Vector3f> raysOf(const PinholeCamera& camera) {
  const int columns = (camera.width - 1) / kRaySpacing + 2;
  const int rows = (camera.height - 1) / kRaySpacing + 2;
  std::vector<Eigen::Vector3d> exact;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const Eigen::Vector3d ray = camera.rayOf({i * kRaySpacing, j * kRaySpacing});
      exact.push_back(ray);
    }
  std::vector<Eigen::Vector3f> rays;
  rays.reserve(static_cast<std::size_t>(camera.width * camera.height));
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d* const corner =
          exact.data() + (v / kRaySpacing) * columns + u / kRaySpacing;
      const double s = static_cast<double>(u % kRaySpacing) / kRaySpacing;
      const double t = static_cast<double>(v % kRaySpacing) / kRaySpacing;
      const Eigen::Vector3d ray = (1.0 - t) * ((1.0 - s) * corner[0] + s * corner[1]) +
                                  t * ((1.0 - s) * corner[columns] + s * corner[columns + 1]);
      rays.push_back(ray.normalized().cast<float>());
    }
  return rays;
}

double shareOf(const Film& film, std::size_t k, double alone) {
  const auto seen = std::count(film.seen.begin(), film.seen.end(), static_cast<int>(k));
  return alone > 0.0 ? static_cast<double>(seen) / alone : 0.0;
}

}  // namespace

StereoRenderer::StereoRenderer(const StereoCamera& camera) : camera_(camera) {
  checkStereoCamera(camera);
  left_rays_ = raysOf(camera.left);
  right_rays_ = raysOf(camera.right);
}

StereoExposure StereoRenderer::expose(const DebridementScene& scene,
                                      const Pose& X_field_camera) const {
  const SceneLighting lighting(scene);
  const SceneSurface surface(scene, lighting);
  const Pose X_left_right{Eigen::Vector3d(camera_.baseline(), 0.0, 0.0),
                          Eigen::Quaterniond::Identity()};
  std::vector<double> alone_left;
  std::vector<double> alone_right;
  Film left = View(scene, surface, camera_.left, X_field_camera, left_rays_).expose(alone_left);
  Film right = View(scene, surface, camera_.right, X_field_camera * X_left_right, right_rays_)
                   .expose(alone_right);
  StereoExposure exposure;
  exposure.width = left.width;
  exposure.height = left.height;
  exposure.sensor = scene.sensor;
  for (std::size_t k = 0; k < scene.fragments.size(); ++k)
    exposure.fragments.push_back({measureFragment(scene.fragments[k]),
                                  shareOf(left, k, alone_left[k]),
                                  shareOf(right, k, alone_right[k])});
  exposure.left = std::move(left.light);
  exposure.right = std::move(right.light);
  return exposure;
}

StereoPicture develop(const StereoExposure& exposure, std::uint64_t noise_seed) {
  const auto one = [&](const std::vector<Eigen::Vector3f>& light, std::uint64_t seed) {
    return developOne(light, exposure.width, exposure.height, exposure.sensor, seed);
  };
  return {one(exposure.left, 2 * noise_seed), one(exposure.right, 2 * noise_seed + 1),
          exposure.fragments};
}

}  // namespace raven_correction
