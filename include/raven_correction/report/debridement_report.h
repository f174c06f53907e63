// SPDX-License-Identifier: BSD-3-Clause
// The debridement experiment with the paper's numbers beside ours: a table for people, JSON for
// programs, a page with figures. The numbers are made in evaluation/debridement_trial.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raven_correction/evaluation/debridement_trial.h"
#include "raven_correction/report/run_record.h"

namespace raven_correction {

/// What the correctors said of the desired poses that they were sent.
struct CorrectedPoses {
  std::uint64_t all = 0;
  std::uint64_t corrected = 0;  ///< of all
  std::uint64_t reduced = 0;    ///< of the corrected ones: faded, limited, or the rigid step alone
};

struct DebridementCondition {
  std::string name;              ///< baseline, corrected or corrected_replanning
  double speed = 0.0;            ///< peak [m/s]
  double replan_interval = 0.0;  ///< 0: open loop [s]
  /// Replans where more is predicted [m]; 0: never; below 0: each arm by its own
  /// DebridementLearning::usual_prediction.
  double deviation_limit = 0.0;
  std::vector<ClearedField> fields;
  double clearance = 0.0;  ///< smallest distance of the instruments; infinite for one [m]
  CorrectedPoses poses;
};

struct DebridementLearning {
  std::string arm;
  std::string model;                         ///< id
  unsigned places = 0;                       ///< of its last rehearsal
  unsigned pairs = 0;                        ///< of command and observation in it, after cleaning
  double before_mm = 0.0, after_mm = 0.0;    ///< held-out, norm of mean absolute errors
  double before_deg = 0.0, after_deg = 0.0;  ///< likewise
  unsigned trial_places = 0;  ///< like those of the task, visited with the correction
  /// There, at rest, by motion capture: the median deviation of each axis, base frame, and the
  /// median of its length [m]; nan without any.
  Eigen::Vector3d trial_median = Eigen::Vector3d::Zero();
  double trial_deviation = 0.0;
  /// One standard deviation of the position as the correction predicts it, that of three in four of
  /// these places at most [m]; infinite where it said nothing.
  double usual_prediction = 0.0;
};

struct DebridementReport {
  std::vector<DebridementCondition> conditions;
  std::vector<DebridementLearning> learning;
  unsigned arms = 0;
  unsigned attempts = 0;  ///< until a fragment is given up
  std::uint64_t seed = 0;
  double look_time = 0.0;   ///< that a picture counts [s]
  double clock_rate = 0.0;  ///< simulated seconds per real second that were reached [-]
  double stood = 0.0;       ///< real time in which the clock stood for pictures [s]
  std::uint64_t cycles = 0, late_cycles = 0;  ///< of the simulator
  std::string folder;                         ///< bags and models; empty: not kept
};

std::string debridementText(const DebridementReport& report);

/// {NAME of condition: {"seconds_per_fragment", "seconds_per_fragment_interval": [lo, hi],
/// "success_percent", "success_percent_interval", "fragments", "delivered", "given_up", "attempts",
/// "retries_per_fragment", "first_try_percent", "missed_grasps", "dropped", "replans",
/// "arm_seconds_per_fragment", "seconds", "waited_seconds", "speed_cm_per_s", "replan_interval_s",
/// "deviation_limit_mm" (null: each arm's own usual_prediction_mm, see "training"),
/// "smallest_distance_mm" (null for one arm), "poses", "poses_corrected_percent",
/// "poses_reduced_percent" (of all, null without poses), "scenes": [...]},
/// "speedup", "speedup_interval": [lo, hi], "speedup_replanning", "speedup_replanning_interval",
/// "success_difference_percent", "success_difference_interval_percent": [lo, hi] (corrected less
/// baseline, same scenes), the same with "_replanning",
/// "paper": {...}, "arms", "seed", "training": [...], "simulator": {...}, "folder"}
std::string debridementJson(const DebridementReport& report);

std::string debridementHtml(const DebridementReport& report, const RunRecord& run);

}  // namespace raven_correction
