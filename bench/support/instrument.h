// SPDX-License-Identifier: BSD-3-Clause
// Planner and subscriber of a benchmark are its measuring instrument: their threads have real-time
// priority, so that poses wait on the way that is measured and not at its ends.
#pragma once

#include <ros/callback_queue.h>

#include <boost/make_shared.hpp>
#include <iostream>

#include "raven_correction/ros/realtime.h"

namespace raven_correction {
namespace bench {

constexpr int kInstrumentPriority = 20;  ///< above relay and corrector

/// Of the calling thread; where the system refuses, it says so once, and the figures are those of
/// the instrument, too.
inline void becomeInstrument() {
  static const bool said = [] {
    const std::string refusal = takeRealtimePriority(kInstrumentPriority);
    if (!refusal.empty())
      std::cerr << "bench: planner and subscriber may stall: " << refusal << "\n";
    return true;
  }();
  if (said) takeRealtimePriority(kInstrumentPriority);
}

/// Of the thread that spins a queue: the first thing that it does.
inline void makeInstrument(ros::CallbackQueue& queue) {
  class Beginning : public ros::CallbackInterface {
    CallResult call() override {
      becomeInstrument();
      return Success;
    }
  };
  queue.addCallback(boost::make_shared<Beginning>());
}

/// Of roscpp's thread of this process.
inline void makeSocketsInstrument() {
  const std::string refusal = giveSocketsRealtimePriority(kInstrumentPriority);
  if (!refusal.empty()) std::cerr << "bench: sockets may stall: " << refusal << "\n";
}

}  // namespace bench
}  // namespace raven_correction
