// SPDX-License-Identifier: BSD-3-Clause
// Waits for a condition, so that no test sleeps for a time somebody guessed.
#pragma once

#include <chrono>
#include <thread>

namespace raven_correction {

/// Asks every 5 ms. @return false if the condition does not hold within `limit` seconds
template <typename Condition>
bool waitFor(Condition condition, double limit) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace raven_correction
