// SPDX-License-Identifier: BSD-3-Clause
// A periodic pattern of smooth random values, from which tissue and foam get their texture. Made
// once, the same in every process.
#pragma once

#include <vector>

namespace raven_correction {

class NoisePattern {
 public:
  static constexpr int kSize = 512;  ///< values per side; a power of two
  /// @param cells    features per side of the coarsest octave
  /// @param octaves  each twice as fine and half as strong as the one before
  NoisePattern(int cells, int octaves, unsigned seed);
  /// Mean 0, standard deviation 1, about normally distributed; period kSize in both arguments.
  float at(double x, double y) const noexcept;

 private:
  std::vector<float> values_;
};

/// Features of a sixteenth of the period, and finer.
const NoisePattern& coarsePattern();
/// Features of two values, without any coarser.
const NoisePattern& finePattern();

}  // namespace raven_correction
