// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/debridement_scene.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr int kPlacements = 60;     // tries to find room for a fragment
constexpr int kSurfaceRings = 9;    // of points that stand for a body when it is laid down
constexpr int kSurfaceSpokes = 24;  // points per ring
constexpr double kContact = 2e-5;   // how exactly a body is laid down [m]
constexpr double kSlide = 1e-4;     // step in which a body is moved away from another [m]

/// Uniform numbers from one engine.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random(seed) {}
  double operator()(double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
  }
  int integer(int lower, int upper) {
    return std::uniform_int_distribution<int>(lower, upper)(random);
  }
  /// Each component of a colour multiplied by its own factor about 1.
  Eigen::Vector3d tint(const Eigen::Vector3d& colour, double spread) {
    return colour.cwiseProduct(Eigen::Vector3d((*this)(1.0 - spread, 1.0 + spread),
                                               (*this)(1.0 - spread, 1.0 + spread),
                                               (*this)(1.0 - spread, 1.0 + spread)));
  }
  std::mt19937_64 random;
};

/// Points on the surface, in the frame of the fragment: rings of equal height.
std::vector<Eigen::Vector3d> surfaceOf(const FoamFragment& fragment) {
  std::vector<Eigen::Vector3d> points;
  for (int ring = 0; ring < kSurfaceRings; ++ring) {
    const double latitude = M_PI * ((ring + 0.5) / kSurfaceRings - 0.5);
    for (int spoke = 0; spoke < kSurfaceSpokes; ++spoke) {
      const double longitude = 2.0 * M_PI * spoke / kSurfaceSpokes;
      const Eigen::Vector3d d(std::cos(latitude) * std::cos(longitude),
                              std::cos(latitude) * std::sin(longitude), std::sin(latitude));
      double lower = 0.0;
      double upper = fragment.radius;
      for (int step = 0; step < 20; ++step) {
        const double middle = 0.5 * (lower + upper);
        (fragment.inside(middle * d) < 0.0 ? lower : upper) = middle;
      }
      points.push_back(lower * d);
    }
  }
  return points;
}

/// True if a point of one body is inside the other, either way, or under the platform.
bool collides(const FoamFragment& body, const std::vector<Eigen::Vector3d>& surface,
              const std::vector<FoamFragment>& others,
              const std::vector<std::vector<Eigen::Vector3d>>& other_surfaces) {
  for (const Eigen::Vector3d& p : surface)
    if ((body.X_field_fragment * p).z() < 0.0) return true;
  for (std::size_t k = 0; k < others.size(); ++k) {
    const FoamFragment& other = others[k];
    const Eigen::Vector3d gap = body.X_field_fragment.p - other.X_field_fragment.p;
    if (gap.norm() > body.radius + other.radius) continue;
    const Pose X_other_body = other.X_field_fragment.inverse() * body.X_field_fragment;
    for (const Eigen::Vector3d& p : surface)
      if (other.inside(X_other_body * p) < 0.0) return true;
    const Pose X_body_other = X_other_body.inverse();
    for (const Eigen::Vector3d& p : other_surfaces[k])
      if (body.inside(X_body_other * p) < 0.0) return true;
  }
  return false;
}

/// The field while fragments are laid on it.
class Pile {
 public:
  explicit Pile(double half_size) : half_size_(half_size) {}
  std::vector<FoamFragment> fragments;

  bool holds(const FoamFragment& body) const {
    const Eigen::Vector2d p = body.X_field_fragment.p.head<2>().cwiseAbs();
    return p.maxCoeff() + 0.8 * body.radius <= half_size_;
  }
  bool isFree(const FoamFragment& body, double clearance) const {
    return std::all_of(fragments.begin(), fragments.end(), [&](const FoamFragment& other) {
      return (body.X_field_fragment.p - other.X_field_fragment.p).head<2>().norm() >
             body.radius + other.radius + clearance;
    });
  }
  /// Lowers a body onto the platform and what lies there, as it is turned, without letting it
  /// topple.
  void drop(FoamFragment& body) const {
    const std::vector<Eigen::Vector3d> surface = surfaceOf(body);
    double& z = body.X_field_fragment.p.z();
    double free = 0.05;
    double blocked = 0.0;
    while (free - blocked > kContact) {
      z = 0.5 * (free + blocked);
      (collides(body, surface, fragments, surfaces_) ? blocked : free) = z;
    }
    z = free;
  }
  /// No other than one fragment is within reach of a body.
  bool touchesOnly(const FoamFragment& body, std::size_t index) const {
    for (std::size_t k = 0; k < fragments.size(); ++k)
      if (k != index && (body.X_field_fragment.p - fragments[k].X_field_fragment.p).norm() <
                            0.85 * (body.radius + fragments[k].radius))
        return false;
    return true;
  }
  /// Moves a body that lies on the platform away from what it touches.
  bool slide(FoamFragment& body, const Eigen::Vector2d& direction) const {
    const std::vector<Eigen::Vector3d> surface = surfaceOf(body);
    for (int step = 0; step < 100; ++step) {
      if (!collides(body, surface, fragments, surfaces_)) return true;
      body.X_field_fragment.p.head<2>() += kSlide * direction;
    }
    return false;
  }
  void add(const FoamFragment& body) {
    fragments.push_back(body);
    surfaces_.push_back(surfaceOf(body));
    carries_.push_back(body.X_field_fragment.q.vec().head<2>().norm() > 1e-6);
  }
  /// Nothing lies on it, and it lies on the platform: something may be leant on it.
  bool isFlat(std::size_t index) const { return !carries_[index]; }
  void load(std::size_t index) { carries_[index] = true; }

 private:
  double half_size_;
  std::vector<std::vector<Eigen::Vector3d>> surfaces_;
  std::vector<bool> carries_;  // or leans itself: two layers, not more
};

bool placeAlone(FoamFragment& body, const Pile& pile, const DebridementSceneConfig& config,
                Draw& draw) {
  const double half = 0.5 * config.field_size;
  for (int i = 0; i < kPlacements; ++i) {
    body.X_field_fragment.p = {draw(-half, half), draw(-half, half), body.half_size.z()};
    body.X_field_fragment.q = expRotation({0.0, 0.0, draw(-M_PI, M_PI)});
    if (!pile.holds(body) || !pile.isFree(body, config.clearance)) continue;
    pile.drop(body);
    return true;
  }
  return false;
}

/// Against another fragment, or partly on top of it and then tilted, as it leans on it.
bool placeBeside(FoamFragment& body, Pile& pile, Draw& draw) {
  for (int i = 0; i < kPlacements; ++i) {
    const auto index =
        static_cast<std::size_t>(draw.integer(0, static_cast<int>(pile.fragments.size()) - 1));
    if (!pile.isFlat(index)) continue;
    const FoamFragment& other = pile.fragments[index];
    const double angle = draw(-M_PI, M_PI);
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    const bool leans = draw(0.0, 1.0) < 0.6;
    const double reach = body.half_size.head<2>().mean() + other.half_size.head<2>().mean();
    const double gap = reach * (leans ? draw(0.55, 0.95) : draw(0.9, 1.1));
    body.X_field_fragment.p.head<2>() = other.X_field_fragment.p.head<2>() + gap * direction;
    body.X_field_fragment.p.z() = body.half_size.z();
    body.X_field_fragment.q = expRotation({0.0, 0.0, draw(-M_PI, M_PI)});
    if (!pile.holds(body)) continue;
    if (leans) {
      // The edge that lies on the other one is as much higher as that one is high, at most.
      const double rise = draw(0.5, 1.0) * 2.0 * other.half_size.z();
      const double tilt = std::atan2(rise, 2.0 * body.half_size.head<2>().mean());
      const Eigen::Vector3d axis(-direction.y(), direction.x(), 0.0);
      body.X_field_fragment.q =
          (expRotation(std::min(tilt, 0.6) * axis) * body.X_field_fragment.q).normalized();
      pile.drop(body);
      if (!pile.touchesOnly(body, index)) continue;
      pile.load(index);
    } else if (!pile.slide(body, direction) || !pile.holds(body)) {
      continue;
    } else {
      pile.drop(body);
    }
    return true;
  }
  return false;
}

void addStains(const DebridementSceneConfig& config, Draw& draw, DebridementScene& scene) {
  const double half = 0.5 * config.field_size;
  for (int stains = draw.integer(0, config.stains_max); stains > 0; --stains) {
    Stain stain;
    stain.half_size = {draw(0.002, 0.006), draw(0.002, 0.004)};
    stain.yaw = draw(-M_PI, M_PI);
    stain.albedo = draw(0.3, 0.6) * Eigen::Vector3d(1.0, draw(0.08, 0.2), draw(0.08, 0.2));
    for (int i = 0; i < kPlacements; ++i) {
      stain.centre = {draw(-half, half), draw(-half, half)};
      const bool free = std::all_of(
          scene.fragments.begin(), scene.fragments.end(), [&](const FoamFragment& fragment) {
            // As the cameras see it, a fragment covers more than it stands on.
            return (fragment.X_field_fragment.p.head<2>() - stain.centre).norm() >
                   fragment.radius + stain.half_size.maxCoeff() + 0.005;
          });
      if (!free) continue;
      scene.stains.push_back(stain);
      break;
    }
  }
}

void chooseLight(Draw& draw, DebridementScene& scene) {
  scene.tissue = draw.tint(draw(0.75, 1.15) * Eigen::Vector3d(0.75, 0.42, 0.40), 0.1);
  scene.vessel = draw.tint(draw(0.8, 1.1) * Eigen::Vector3d(0.50, 0.20, 0.18), 0.1);
  scene.fat = draw.tint(scene.fat, 0.1);
  const Eigen::Vector3d drapes[] = {{0.08, 0.22, 0.28}, {0.10, 0.25, 0.14}, {0.35, 0.36, 0.38}};
  scene.drape = draw.tint(drapes[draw.integer(0, 2)], 0.15);
  scene.pattern = {draw(0.0, 0.1), draw(0.0, 0.1), draw(-M_PI, M_PI)};
  scene.mottle = draw(0.05, 0.2);
  scene.wetness = draw(0.0, 1.0);

  const double elevation = draw(0.7, 1.4);
  const double azimuth = draw(-M_PI, M_PI);
  SceneLight& light = scene.light;
  light.lamp_direction = {std::cos(elevation) * std::cos(azimuth),
                          std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
  light.lamp_size = draw(0.02, 0.15);
  const double lamp_share = draw(0.45, 0.8);
  light.lamp = draw.tint(Eigen::Vector3d::Constant(lamp_share / std::sin(elevation)), 0.06);
  light.room = draw.tint(Eigen::Vector3d::Constant(1.0 - lamp_share), 0.1);
  SceneSensor& sensor = scene.sensor;
  sensor.gain = draw.tint(Eigen::Vector3d::Constant(draw(0.45, 1.5)), 0.12);
  sensor.vignetting = draw(0.0, 0.35);
  sensor.blur = draw(0.05, 0.2);
  sensor.shot_noise = draw(5e-5, 4e-4);
  sensor.read_noise = draw(1e-3, 6e-3);
}

}  // namespace

DebridementScene makeDebridementScene(const DebridementSceneConfig& config, std::uint64_t seed) {
  if (!(config.fragments_min >= 0 && config.fragments_max >= config.fragments_min))
    throw InvalidInput(format("debridement scene: from %d to %d fragments is no range",
                              config.fragments_min, config.fragments_max));
  if (!(config.field_size > 0.0 && config.neighbour_share >= 0.0 && config.neighbour_share <= 1.0 &&
        config.clearance >= 0.0 && config.stains_max >= 0))
    throw InvalidInput(
        format("debridement scene: field_size = %g m (> 0), neighbour_share = %g "
               "([0, 1]), clearance = %g m (>= 0), stains_max = %d (>= 0)",
               config.field_size, config.neighbour_share, config.clearance, config.stains_max));
  Draw draw(seed);
  DebridementScene scene;
  Pile pile(0.5 * config.field_size);
  for (int n = draw.integer(config.fragments_min, config.fragments_max); n > 0; --n) {
    FoamFragment body = cutFoam(config.foam, draw.random);
    const bool beside = !pile.fragments.empty() && draw(0.0, 1.0) < config.neighbour_share;
    if (beside ? placeBeside(body, pile, draw) : placeAlone(body, pile, config, draw))
      pile.add(body);
  }
  scene.fragments = pile.fragments;
  chooseLight(draw, scene);
  addStains(config, draw, scene);
  return scene;
}

StereoRigConfig variedRig(const StereoRigConfig& config, std::uint64_t seed) {
  Draw draw(seed ^ 0x9e3779b97f4a7c15u);
  StereoRigConfig rig = config;
  rig.distance *= draw(0.95, 1.08);
  rig.tilt += draw(-0.12, 0.12);
  rig.azimuth += draw(-0.3, 0.3);
  return rig;
}

}  // namespace raven_correction
