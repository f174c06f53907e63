// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/evaluation/fragment_trial.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr double kHalf = 0.5;
constexpr double kWhole = 0.95;

cv::Mat asMat(const ColourImage& image) {
  // cv::Mat does not know of const data; the detector does not write it.
  return {image.height, image.width, CV_8UC3, const_cast<std::uint8_t*>(image.bgr.data())};
}

FragmentMatch compare(const VisibleFragment& fragment, const FragmentDetection& detection) {
  FragmentMatch match;
  const Eigen::Vector3d error = detection.p_field - fragment.truth.p_field;
  match.visible = std::min(fragment.visible_left, fragment.visible_right);
  match.distance = error.norm();
  match.mahalanobis2 = error.dot(detection.covariance.ldlt().solve(error));
  match.yaw_error = std::remainder(detection.yaw - fragment.truth.yaw, M_PI);
  match.yaw_deviation = detection.yaw_deviation;
  match.slenderness = fragment.truth.length / fragment.truth.width;
  match.partly_hidden = detection.partly_hidden;
  return match;
}

/// Seen from above, the outline taken for an ellipse.
bool liesOn(const FragmentDetection& detection, const FragmentTruth& fragment) {
  const Eigen::Vector2d along(std::cos(fragment.yaw), std::sin(fragment.yaw));
  const Eigen::Vector2d off = (detection.p_field - fragment.p_field).head<2>();
  const double u = off.dot(along) / (0.5 * fragment.length);
  const double v = (along.x() * off.y() - along.y() * off.x()) / (0.5 * fragment.width);
  return u * u + v * v <= 1.0;
}

}  // namespace

double FragmentScore::foundShare() const {
  return half_visible > 0 ? static_cast<double>(half_visible_found) / half_visible : 1.0;
}

double FragmentScore::withinShare(double limit) const {
  if (matches.empty()) return 1.0;
  const auto near = std::count_if(matches.begin(), matches.end(),
                                  [limit](const FragmentMatch& m) { return m.distance <= limit; });
  return static_cast<double>(near) / static_cast<double>(matches.size());
}

void scoreDetections(const std::vector<VisibleFragment>& truth,
                     const std::vector<FragmentDetection>& detections, double reach,
                     FragmentScore& score) {
  struct Pair {
    double distance;
    std::size_t fragment;
    std::size_t detection;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < truth.size(); ++i)
    for (std::size_t j = 0; j < detections.size(); ++j) {
      const double distance = (truth[i].truth.p_field - detections[j].p_field).norm();
      if (distance <= reach) pairs.push_back({distance, i, j});
    }
  std::sort(pairs.begin(), pairs.end(),
            [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
  std::vector<bool> found(truth.size(), false);
  std::vector<bool> used(detections.size(), false);
  for (const Pair& pair : pairs) {
    if (found[pair.fragment] || used[pair.detection]) continue;
    found[pair.fragment] = true;
    used[pair.detection] = true;
    const FragmentMatch match = compare(truth[pair.fragment], detections[pair.detection]);
    if (match.visible >= kHalf) score.matches.push_back(match);
  }
  ++score.scenes;
  score.fragments += static_cast<int>(truth.size());
  score.detections += static_cast<int>(detections.size());
  std::vector<bool> taken = found;  // by a detection, near or not
  for (std::size_t j = 0; j < detections.size(); ++j) {
    if (used[j]) continue;
    std::size_t i = 0;
    while (i < truth.size() && (taken[i] || !liesOn(detections[j], truth[i].truth))) ++i;
    ++(i < truth.size() ? score.displaced : score.false_detections);
    if (i < truth.size()) taken[i] = true;
  }
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double visible = std::min(truth[i].visible_left, truth[i].visible_right);
    if (visible < kHalf) continue;
    ++score.half_visible;
    score.half_visible_found += found[i];
    if (visible >= kWhole) continue;
    ++score.overlapped;
    score.overlapped_found += found[i];
  }
}

FragmentTrialScene renderTrialScene(const FragmentTrial& trial, int index) {
  const std::uint64_t seed = trial.seed + static_cast<std::uint64_t>(index);
  DebridementSceneConfig config = trial.scene;
  if (trial.empty_every > 0 && index % trial.empty_every == trial.empty_every - 1)
    config.fragments_min = config.fragments_max = 0;
  FragmentTrialScene scene{makeStereoRig(variedRig(trial.rig, seed)), {}};
  const StereoExposure exposure =
      StereoRenderer(scene.rig.camera)
          .expose(makeDebridementScene(config, seed), scene.rig.X_field_camera);
  scene.picture = develop(exposure, seed);
  return scene;
}

FragmentScore runFragmentTrial(const FragmentTrial& trial, const std::function<void(int)>& watch) {
  if (trial.scenes <= 0)
    throw InvalidInput(format("fragment trial: %d scenes, must be > 0", trial.scenes));
  if (!(trial.reach > 0.0))
    throw InvalidInput(format("fragment trial: reach = %g m, must be > 0", trial.reach));
  FragmentScore score;
  for (int k = 0; k < trial.scenes; ++k) {
    const FragmentTrialScene scene = renderTrialScene(trial, k);
    const FragmentDetector detector(scene.rig.camera, scene.rig.X_field_camera, trial.detector);
    const auto begin = std::chrono::steady_clock::now();
    const std::vector<FragmentDetection> detections =
        detector.detect(asMat(scene.picture.left), asMat(scene.picture.right));
    score.detection_time.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    scoreDetections(scene.picture.fragments, detections, trial.reach, score);
    if (watch) watch(k);
  }
  return score;
}

}  // namespace raven_correction
