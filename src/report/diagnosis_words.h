// SPDX-License-Identifier: BSD-3-Clause
// How a verdict is put into words, for the terminal and for the page: names, units, lists. What the
// words say is diagnosis_report.cpp and diagnosis_html.cpp.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/diagnosis/diagnose.h"

namespace raven_correction {

/// Parameters of a cause with what a person calls them: parameterNames().
struct NamedParameter {
  std::string symbol, unit;
  double value, deviation;
};
std::vector<NamedParameter> parametersOf(const Verdict& verdict, const Cause& cause);
std::vector<NamedParameter> parametersOf(const Verdict& verdict, const Rival& rival);
/// "w = 0.031 +- 0.001 rad"; without a deviation where it has none.
std::string parameterText(const NamedParameter& parameter, const char* plus_minus);

/// "a, b and c".
std::string joined(const std::vector<std::string>& words, const char* last);

std::vector<std::string> equalLabels(const Verdict& verdict, const Cause& cause);
/// "cannot be told here from", or that the motions speak for the rival, where it predicts
/// significantly better than the cause, which was chosen beside fewer others.
const char* relationTo(const Rival& rival);
/// How near a rival is to its cause: "98 % of its gain, log likelihood 0.3 lower (z 0.4); were the
/// cause the truth, this recording would show 0.9 on average".
std::string rivalText(const Rival& rival);
/// "m" or "rad".
const char* jointUnit(const Verdict& verdict, std::size_t joint);

/// All that a residual was held against, the single delay first, without the sum of them.
std::vector<Dependence> orderedGroups(const DependenceResult& result);

/// What is left, in one sentence.
std::string unexplainedText(const Verdict& verdict);

}  // namespace raven_correction
