// SPDX-License-Identifier: BSD-3-Clause
// Uses what other packages are meant to use: a header-only type, a function of the core library,
// its exception, and a message.
#include <raven_correction/Pair.h>

#include <cstdio>

#include "raven_correction/error.h"
#include "raven_correction/geometry/pose.h"

int main() {
  const raven_correction::Pose X_base_tool;
  const raven_correction::Pair pair;
  if (!raven_correction::hasUnitQuaternion(X_base_tool) || !pair.trajectory.empty()) return 1;
  try {
    throw raven_correction::InvalidInput(raven_correction::format("core answers %d", 42));
  } catch (const raven_correction::InvalidInput& error) {
    std::puts(error.what());
  }
  return 0;
}
