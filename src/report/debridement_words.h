// SPDX-License-Identifier: BSD-3-Clause
// What the table, the JSON and the page of the debridement experiment share.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "raven_correction/report/debridement_report.h"

namespace raven_correction {

constexpr char kBaseline[] = "baseline";
constexpr char kCorrected[] = "corrected";
constexpr char kCorrectedReplanning[] = "corrected_replanning";
// Mahler et al. 2014, section V-D.
constexpr double kPaperSpeedUp = 3.8;
constexpr double kPaperSecondsPerFragment = 15.8;

double firstTryShare(const DebridementSummary& summary);
double percentOf(std::uint64_t part, std::uint64_t all);  ///< 0 of nothing
double latePercent(const DebridementReport& report);
const DebridementCondition* conditionOf(const DebridementReport& report, const std::string& name);
/// Of a condition over the baseline; nothing where one of them is missing.
std::optional<PairedComparison> speedUpOf(const DebridementReport& report, const std::string& fast);
/// Success of a condition less that of the baseline; nothing where one of them is missing.
std::optional<PairedComparison> successOf(const DebridementReport& report, const std::string& name);
/// "lower", "higher", or that these scenes do not tell.
const char* successWords(const PairedComparison& difference);

/// One line of the table.
struct DebridementRow {
  const char* name;
  std::string (*value)(const DebridementCondition& condition, const DebridementSummary& summary);
};
const std::vector<DebridementRow>& debridementRows();

}  // namespace raven_correction
