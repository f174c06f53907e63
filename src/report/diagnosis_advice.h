// SPDX-License-Identifier: BSD-3-Clause
// What to do about a verdict: at the robot, with the recording, with the extended simulation. The
// verdict itself is diagnosis/diagnose.h.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/diagnosis/diagnose.h"
#include "raven_correction/report/html_document.h"

namespace raven_correction {

/// What a cause is, in plain words, and what a person can do about it at the robot.
struct EffectAdvice {
  std::string meaning;
  std::string remedy;
};
/// Empty texts for an effect that this table does not know.
EffectAdvice adviceFor(const std::string& effect);

/// Steps in the order of what they promise. @param extended  simulation file that was written, or
/// empty
std::vector<std::string> nextSteps(const Verdict& verdict, const std::string& extended);

/// One sentence, and whether it is good news.
struct Headline {
  Tone tone = Tone::kNotice;
  std::string text;
};
Headline headlineOf(const Verdict& verdict);

}  // namespace raven_correction
