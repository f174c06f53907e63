// SPDX-License-Identifier: BSD-3-Clause
// Table II of the paper with its numbers beside ours: a table for people, JSON for programs, a page
// with figures. The numbers are made in evaluation/repeatability.h.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "raven_correction/evaluation/repeatability.h"
#include "raven_correction/report/run_record.h"

namespace raven_correction {

struct RepeatabilityCondition {
  std::string name;  ///< none, full or endpoint
  RepeatabilityResult result;
  std::map<std::string, std::uint64_t> codes;  ///< of the corrector, how often each
};

struct RepeatabilityReport {
  std::vector<RepeatabilityCondition> conditions;
  std::size_t poses = 0, visits = 0;  ///< asked for; visits of each pose
  std::uint64_t seed = 0;
  std::string model;                      ///< id
  std::size_t training_trajectories = 0;  ///< recorded to learn from
  std::size_t training_pairs = 0;         ///< kept of them
  std::string folder;                     ///< bags and model; empty: not kept
  std::string measured_by = "motion capture, median of the last 0.3 s of each visit";
  /// Of the simulator: cycles that came more than a period late lose simulated time, not commands.
  std::uint64_t cycles = 0, late_cycles = 0;
  double clock_rate = 0.0;  ///< simulated seconds per real second that were reached [-]
};

/// Norm of the mean absolute position errors, "full" over "none"; NaN where one is missing.
double correctedShare(const RepeatabilityReport& report);

std::string repeatabilityText(const RepeatabilityReport& report);

/// {"conditions": {NAME: {"mean_abs_mm": [3], "std_mm": [3], "abs_std_mm": [3],
/// "mean_error_mm": [3], "mean_abs_deg": [3], "std_deg": [3], "abs_std_deg": [3],
/// "mean_error_deg": [3], "position_norm_mm", "angle_norm_deg", "n", "unseen", "corrector": {code:
/// count}}}, "paper": {NAME: {"mean_abs_mm", "std_mm"}}, "full_over_none", "poses", "visits",
/// "seed", "measured_by", "model", "training": {"trajectories", "pairs"}, "simulator": {"cycles",
/// "late_percent", "clock_rate"}, "folder"}. std is the repeatability, abs_std the deviation of the
/// absolute errors of all visits; order x, y, z and yaw, pitch, roll.
std::string repeatabilityJson(const RepeatabilityReport& report);

std::string repeatabilityHtml(const RepeatabilityReport& report, const RunRecord& run);

}  // namespace raven_correction
