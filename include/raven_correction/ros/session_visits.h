// SPDX-License-Identifier: BSD-3-Clause
// The visits of a recorded session: every trajectory whose events name a target, measured at rest.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/evaluation/visits.h"

namespace raven_correction {

/// Sorted by start.
/// @param file  bag
/// @param rest  see measureVisit() [s]
/// @throws InvalidInput  see readSessionBag(); or no event with a target is in it
std::vector<Visit> readVisits(const std::string& file, double rest);

}  // namespace raven_correction
