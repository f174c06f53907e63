// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/dataset/stream_finding.h"

#include <algorithm>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

using Severity = StreamFinding::Severity;

}  // namespace

std::string toText(const StreamFinding& finding) {
  return std::string(finding.severity == Severity::kError ? "error: " : "warning: ") +
         finding.stream + ": " + finding.what + ": " + finding.measured + " (" + finding.limit +
         "); " + finding.remedy;
}

bool anyError(const std::vector<StreamFinding>& findings) noexcept {
  return std::any_of(findings.begin(), findings.end(), [](const StreamFinding& finding) {
    return finding.severity == Severity::kError;
  });
}

void refuseErrors(const std::string& source, const std::vector<StreamFinding>& findings,
                  const std::string& exception) {
  if (!anyError(findings)) return;
  std::string text = source + ": the recording is not to be trusted:";
  for (const StreamFinding& finding : findings) text += "\n  " + toText(finding);
  throw InvalidInput(text + "\nto use it in spite of this: " + exception);
}

}  // namespace raven_correction
