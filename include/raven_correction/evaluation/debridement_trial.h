// SPDX-License-Identifier: BSD-3-Clause
// How well fields were cleared of fragments: time per fragment, success, retries, and by how much
// one way of doing it is faster than another. How a field is cleared is
// simulation/debridement_task.h.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "raven_correction/geometry/statistics.h"
#include "raven_correction/simulation/debridement_task.h"

namespace raven_correction {

/// One scene from its first picture until no arm finds anything left to do.
struct ClearedField {
  std::uint64_t seed = 0;
  unsigned fragments = 0;               ///< that lay there
  unsigned delivered = 0;               ///< of them, to a receptacle: the truth
  unsigned held = 0;                    ///< jaws that closed and held one
  unsigned missed = 0;                  ///< jaws that closed and held none
  unsigned dropped = 0;                 ///< let go elsewhere
  double seconds = 0.0;                 ///< [s]
  double waited = 0.0;                  ///< of that for the other arm, summed over arms [s]
  std::vector<FragmentRecord> records;  ///< of all arms: what their planners believe
};

struct DebridementSummary {
  unsigned scenes = 0, fragments = 0, delivered = 0, given_up = 0, missed = 0, dropped = 0;
  unsigned attempts = 0;
  unsigned first_tries = 0;     ///< fragments that were worked on
  unsigned first_try_held = 0;  ///< of them picked up at the first attempt
  unsigned replans = 0;
  double seconds = 0.0;               ///< of all scenes [s]
  double seconds_per_fragment = 0.0;  ///< seconds / delivered; infinite where none was [s]
  double busy_per_fragment = 0.0;     ///< mean time of an arm for a delivered fragment [s]
  double success = 0.0;               ///< delivered / fragments
  double retries = 0.0;               ///< attempts beyond the first per fragment worked on
  double waited = 0.0;                ///< for the other arm [s]
  Interval seconds_interval;          ///< 95 %, bootstrap over scenes [s]
  Interval success_interval;          ///< likewise
};
/// @throws InvalidInput  no scene
DebridementSummary summarise(const std::vector<ClearedField>& fields, std::uint64_t seed);

/// How two conditions differ in the same scenes. The interval is of these scenes and these models:
/// arms that learn again differ, too.
struct PairedComparison {
  double value = 0.0;
  Interval interval;  ///< 95 %, bootstrap over scenes, the same ones drawn for both
};
/// Seconds per fragment of `slow` over those of `fast`: 0 where `fast` delivered nothing.
/// @return nothing where `slow` delivered nothing
/// @throws InvalidInput  not the same scenes
std::optional<PairedComparison> speedUp(const std::vector<ClearedField>& slow,
                                        const std::vector<ClearedField>& fast, std::uint64_t seed);
/// Success of `other` less that of `reference` [-].
/// @throws InvalidInput  not the same scenes
PairedComparison successDifference(const std::vector<ClearedField>& reference,
                                   const std::vector<ClearedField>& other, std::uint64_t seed);

}  // namespace raven_correction
