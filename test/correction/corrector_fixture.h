// SPDX-License-Identifier: BSD-3-Clause
// A corrector and a slow motion inside its trained region, for the tests of corrector_*_test.cpp.
#pragma once

#include <gtest/gtest.h>

#include "raven_correction/correction/corrector.h"
#include "support/simple_model.h"

namespace raven_correction {

inline CorrectorLimits looseLimits() {
  CorrectorLimits limits;
  limits.max_translation_rate = 10.0;  // reaches any correction of these tests in one command
  limits.max_rotation_rate = 100.0;
  return limits;
}

inline bool same(const Pose& a, const Pose& b) {
  return a.p == b.p && a.q.coeffs() == b.q.coeffs();
}

/// A slow motion inside the trained region.
inline Pose inside(int i) { return {{1e-4 * i, 0.01, -0.01}, expRotation({0.02, 0.0, 1e-4 * i})}; }

inline double stampOf(int i) { return 100.0 + 0.02 * i; }

class CorrectorTest : public ::testing::Test {
 protected:
  CorrectorOutput send(Corrector& corrector, int i) {
    return corrector.correct(stampOf(i), stampOf(i), inside(i), false);
  }
  const Correction model_ = simpleModel();
};

}  // namespace raven_correction
