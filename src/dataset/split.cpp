// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/dataset/split.h"

#include <cstdio>

#include "raven_correction/error.h"

namespace raven_correction {

HoldOut parseHoldOut(const std::string& text) {
  HoldOut hold_out;
  char rest = 0;
  const int fields = std::sscanf(text.c_str(), "%d/%d%c", &hold_out.fold, &hold_out.folds, &rest);
  if (fields != 2 || hold_out.folds < 2 || hold_out.fold < 0 || hold_out.fold >= hold_out.folds)
    throw InvalidInput(
        format("hold-out \"%s\" must be K/N with 0 <= K < N and N >= 2, e.g. 0/5", text.c_str()));
  return hold_out;
}

}  // namespace raven_correction
