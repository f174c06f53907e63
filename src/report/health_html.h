// SPDX-License-Identifier: BSD-3-Clause
// Data health as the reports show it: rates and gaps of every stream, and what cleaning rejected.
// The numbers are dataset/stream_health.h and dataset/synchronisation.h.
#pragma once

#include <vector>

#include "raven_correction/dataset/stream_finding.h"
#include "raven_correction/dataset/stream_health.h"
#include "raven_correction/dataset/synchronisation.h"
#include "raven_correction/report/html_document.h"

namespace raven_correction {

/// Table of streams, and a note for each that one should look at.
void appendStreams(const std::vector<StreamHealth>& streams, HtmlDocument& document);

/// A note for each, or that there is none.
void appendFindings(const std::vector<StreamFinding>& findings, HtmlDocument& document);

/// Table and bars of what became of the observations, by reason.
void appendFates(const FateCounts& fates, std::size_t identity_commands, HtmlDocument& document);

}  // namespace raven_correction
