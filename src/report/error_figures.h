// SPDX-License-Identifier: BSD-3-Clause
// Figures of lists of errors of predicted commands, whoever made them: distributions, axes, and
// whether predicted intervals are as wide as the errors.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/evaluation/error_samples.h"
#include "raven_correction/report/figure.h"

namespace raven_correction {

struct ErrorCurve {
  std::string label;
  Ink ink;
  Stroke stroke;
  const ErrorSeries* series;
};
/// Cumulative shares of position and orientation errors.
Figure errorCurvesFigure(const std::vector<ErrorCurve>& curves);

/// Quantile strips per axis, before beside after, with the same limits.
Figure errorAxesFigure(const ErrorSeries& before, const ErrorSeries& after);

/// Observed against nominal coverage.
Figure coverageFigure(const CoverageCurve& curve);

}  // namespace raven_correction
