// SPDX-License-Identifier: BSD-3-Clause
// How well fragments are found: rendered scenes, the detector, and what the truth says about each
// detection. The renderer knows the detector not, nor the other way round.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "raven_correction/perception/fragment_detector.h"
#include "raven_correction/simulation/stereo_renderer.h"

namespace raven_correction {

/// A fragment and what was said about it.
struct FragmentMatch {
  double visible = 0.0;        ///< share of it that is seen, in the image where this is less
  double distance = 0.0;       ///< detection from the centre of its volume [m]
  double mahalanobis2 = 0.0;   ///< of that error by the detection's covariance; mean 3 if right [-]
  double yaw_error = 0.0;      ///< in (-pi/2, pi/2] [rad]
  double yaw_deviation = 0.0;  ///< as predicted [rad]
  double slenderness = 1.0;    ///< true length / width: near 1 there is no direction
  bool partly_hidden = false;  ///< as the detector said
};

struct FragmentScore {
  int scenes = 0;
  int fragments = 0;     ///< in all scenes
  int half_visible = 0;  ///< at least half visible in both images
  int half_visible_found = 0;
  int overlapped = 0;  ///< of half_visible: of these, less than 95 % visible in one
  int overlapped_found = 0;
  int detections = 0;
  int false_detections = 0;  ///< that lie on no fragment, or on one that has a nearer one
  int displaced = 0;  ///< detections that lie on a fragment, further than `reach` from its centre,
                      ///< which has no other: neither found nor false
  std::vector<FragmentMatch> matches;  ///< of the found ones that are half visible
  std::vector<double> detection_time;  ///< of each pair of images [s]

  double foundShare() const;               ///< of half_visible
  double withinShare(double limit) const;  ///< of matches, with distance <= limit [m]
};

/// Detections and fragments are paired by distance, the nearest first, up to `reach`; each counts
/// once. Of what is left, a detection whose centre is above the outline of a fragment (an ellipse)
/// that is left, too, is displaced; all others are false.
/// @param reach  [m]
void scoreDetections(const std::vector<VisibleFragment>& truth,
                     const std::vector<FragmentDetection>& detections, double reach,
                     FragmentScore& score);

struct FragmentTrial {
  int scenes = 200;
  std::uint64_t seed = 1;  ///< of the first scene; the others count on
  int empty_every = 20;    ///< every so many scenes there is no fragment; 0: never
  double reach = 0.003;    ///< see scoreDetections() [m]
  DebridementSceneConfig scene;
  StereoRigConfig rig;  ///< varied with the seed (variedRig())
  FragmentDetectorConfig detector;
};

/// One scene of a trial.
struct FragmentTrialScene {
  StereoRig rig;
  StereoPicture picture;
};
FragmentTrialScene renderTrialScene(const FragmentTrial& trial, int index);

/// @param watch  called after every scene with its index; may be empty
FragmentScore runFragmentTrial(const FragmentTrial& trial,
                               const std::function<void(int)>& watch = {});

}  // namespace raven_correction
