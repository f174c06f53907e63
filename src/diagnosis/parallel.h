// SPDX-License-Identifier: BSD-3-Clause
// A loop over independent pieces of work on all processors that lets exceptions out: the first one
// is thrown again where the loop was started, as OpenMP alone would end the program.
#pragma once

#include <exception>

namespace raven_correction {

/// Calls work(i) for every i in [0, count), in any order and at once. Loops within loops run one
/// after the other.
template <typename Work>
void parallelFor(int count, const Work& work) {
  std::exception_ptr first;
#pragma omp parallel for schedule(dynamic)
  for (int i = 0; i < count; ++i) {
    try {
      work(i);
    } catch (...) {
#pragma omp critical(raven_correction_parallel_for)
      if (!first) first = std::current_exception();
    }
  }
  if (first) std::rethrow_exception(first);
}

}  // namespace raven_correction
