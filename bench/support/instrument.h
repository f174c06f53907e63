// SPDX-License-Identifier: BSD-3-Clause
// Planner and subscriber of a benchmark are its measuring instrument: their threads have real-time
// priority, so that poses wait on the way that is measured and not at its ends.
#pragma once

#include <iostream>
#include <mutex>
#include <string>

#include "raven_correction/ros/realtime.h"

namespace raven_correction {
namespace bench {

constexpr int kInstrumentPriority = 20;  ///< above relay and corrector

/// Of the calling thread; where the system refuses, the figures are those of the instrument, too.
inline void becomeInstrument() {
  const std::string refusal = takeRealtimePriority(kInstrumentPriority);
  static std::once_flag said;
  if (!refusal.empty())
    std::call_once(
        said, [&] { std::cerr << "bench: planner and subscriber may stall: " << refusal << "\n"; });
}

/// Of roscpp's thread of this process.
inline void makeSocketsInstrument() {
  const std::string refusal = giveSocketsRealtimePriority(kInstrumentPriority);
  if (!refusal.empty()) std::cerr << "bench: sockets may stall: " << refusal << "\n";
}

}  // namespace bench
}  // namespace raven_correction
