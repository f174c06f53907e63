// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/simulator_clock.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/error.h"

namespace raven_correction {

SimulatorClock::SimulatorClock(double rate, double start, double max_step)
    : rate_(rate), max_step_(max_step), time_(start) {
  if (!(rate > 0.0 && std::isfinite(rate)))
    throw InvalidInput(format("clock rate = %g, must be > 0; 1 is real time", rate));
  if (!std::isfinite(start)) throw InvalidInput("start of the simulated clock is not finite");
  if (!(max_step > 0.0 && std::isfinite(max_step)))
    throw InvalidInput(format("longest step of the simulated clock = %g s, must be > 0", max_step));
}

double SimulatorClock::advance(double steady) noexcept {
  if (started_) time_ += std::clamp(rate_ * (steady - last_steady_), 0.0, max_step_);
  started_ = true;
  last_steady_ = steady;
  return time_;
}

double SimulatorClock::hold(double steady) noexcept {
  started_ = true;
  last_steady_ = steady;
  return time_;
}

}  // namespace raven_correction
