// SPDX-License-Identifier: BSD-3-Clause
// Simulated time as a multiple of real time, so that a session of ten minutes need not take ten
// minutes. On a busy machine it slows down rather than jumps.
#pragma once

namespace raven_correction {

class SimulatorClock {
 public:
  /// @param rate      simulated seconds per real second, > 0 [-]
  /// @param start     simulated time at the first call of advance() [s]
  /// @param max_step  most that one call advances, > 0 [s]
  /// @throws InvalidInput  a value that is not finite or not in its range
  SimulatorClock(double rate, double start, double max_step);
  /// Simulated time at an instant of a steady clock. Never decreases; what a late call would add
  /// beyond max_step is lost for good.
  /// @param steady  [s], any origin
  double advance(double steady) noexcept;
  /// The clock stands until this instant of the steady clock. @return time()
  double hold(double steady) noexcept;
  double time() const noexcept { return time_; }

 private:
  double rate_;
  double max_step_;
  double time_;
  double last_steady_ = 0.0;
  bool started_ = false;
};

}  // namespace raven_correction
