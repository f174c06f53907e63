// SPDX-License-Identifier: BSD-3-Clause
// Percentiles of a duration that one thread measures and another reports, without lock or
// allocation.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>

namespace raven_correction {

/// Counts durations from 1 us to 65 ms in classes 9 % wide; shorter and longer ones count in the
/// outermost class.
class LatencyHistogram {
 public:
  struct Snapshot {
    std::uint64_t count = 0;
    double p50 = 0.0, p99 = 0.0, p999 = 0.0;  ///< upper border of their class [s]
    double max = 0.0;                         ///< exact [s]
  };

  void add(double seconds) noexcept {
    const double octaves = std::log2(std::max(seconds * 1e6, 1.0));
    const auto index = static_cast<std::size_t>(octaves * kPerOctave);
    counts_[std::min(index, kClasses - 1)].fetch_add(1, std::memory_order_relaxed);
    if (seconds > max_.load(std::memory_order_relaxed))
      max_.store(seconds, std::memory_order_relaxed);
  }

  /// Of what was added since the last call.
  Snapshot take() noexcept {
    std::array<std::uint64_t, kClasses> counts{};
    Snapshot snapshot;
    for (std::size_t i = 0; i < kClasses; ++i)
      snapshot.count += counts[i] = counts_[i].exchange(0, std::memory_order_relaxed);
    snapshot.max = max_.exchange(0.0, std::memory_order_relaxed);
    const auto percentile = [&](double share) {
      const double wanted = share * static_cast<double>(snapshot.count);
      double reached = 0.0;
      for (std::size_t i = 0; i < kClasses; ++i) {
        reached += static_cast<double>(counts[i]);
        if (reached > 0.0 && reached >= wanted)
          return std::min(1e-6 * std::exp2(static_cast<double>(i + 1) / kPerOctave), snapshot.max);
      }
      return 0.0;
    };
    snapshot.p50 = percentile(0.5);
    snapshot.p99 = percentile(0.99);
    snapshot.p999 = percentile(0.999);
    return snapshot;
  }

 private:
  static constexpr double kPerOctave = 8.0;
  static constexpr std::size_t kClasses = 128;
  std::array<std::atomic<std::uint64_t>, kClasses> counts_{};
  std::atomic<double> max_{0.0};
};

}  // namespace raven_correction
