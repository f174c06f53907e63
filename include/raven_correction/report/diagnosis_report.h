// SPDX-License-Identifier: BSD-3-Clause
// A verdict as text for a terminal and as JSON. The diagnosis is diagnosis/diagnose.h.
#pragma once

#include <string>

#include "raven_correction/diagnosis/diagnose.h"

namespace raven_correction {

/// One sentence per cause: "backlash of elbow: w = 0.031 +- 0.001 rad, explains 83 % (79..86 %)".
std::string causeText(const Verdict& verdict, std::size_t cause);

/// The verdict in words first, then the numbers. mm and deg; joint data in rad and m.
std::string diagnosisText(const Verdict& verdict);

/// {"causes": [{"effect", "joints", "label", "parameters": {name: {"value", "std", "unit"}},
///   "explained_percent", "interval_percent": [lo, hi], "indistinguishable_from": [label],
///   "rivals" (one for each such label): [{"label", "parameters", "relative_gain", "z",
///   "log_likelihood_difference", "log_likelihood_expected"}] (see Rival),
///   "separated_by" (where there is such a label), "runner_up" (where there is one): {"label",
///   "relative_share"}}],
///  "unexplained": {"present", "depends_on", "rms_mm", "rms_deg", "share_percent"} (beyond the
///  noise
///   floor; share_percent: of it, predicted from position, direction, speed, load and time),
///  "before", "after", "after_alignment" (where registration or tool frame is a cause):
///  {"position_rms_mm", "position_median_mm",
///   "position_p95_mm", "orientation_median_deg", "orientation_rms_deg", "fold_position_median_mm",
///   "fold_orientation_median_deg"},
///  "gain_percent", "gain_interval_percent", "gain_from_alignment_percent",
///  "gain_from_alignment_interval_percent" (both with after_alignment), "noise_floor_mm",
///  "noise_floor_deg" (0: no frames tell it), "learnable_percent", "learnable_interval_percent",
///  "after_learning" (what a Gaussian process
///   still learns from what is left, on motions held out, and the errors then),
///  "delay" (where commands drive the simulation): {"single_s": of everything, to first order,
///  "slow_motion": [{"joint", "behind_s"}] (delay and lag together)},
///  "depends_on_before", "depends_on_after": {group: {"share_percent", "interval_percent"}},
///  "data": {...}, "converged", "stopped_at_max_causes", "seconds", "seed"}
/// Joint data: errors are objects by joint with keys rms_rad or rms_m, median_..., p95_...; noise
/// floor and what is left beyond it likewise.
std::string diagnosisJson(const Verdict& verdict);

}  // namespace raven_correction
