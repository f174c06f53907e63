// SPDX-License-Identifier: BSD-3-Clause
// The figures of Table I: the ladder of methods, error distributions, folds, calibration. The page
// that they stand on is table_one_html.cpp.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/evaluation/error_samples.h"
#include "raven_correction/report/figure.h"

namespace raven_correction {

constexpr Method kFull = Method::kRigidGpVelocityClean;

const ErrorSummary& meanOfFolds(const TableOneResult& result, const std::string& configuration,
                                Method method, bool clean);
/// By fold; empty where a test set of its own was used.
std::vector<const TableOneRow*> foldsOf(const TableOneResult& result,
                                        const std::string& configuration, Method method,
                                        bool clean);
/// Of the mean absolute errors, mm or deg.
double normOf(const ErrorSummary& errors, bool position);
std::string configurationLabel(const std::string& name);

Figure ladderFigure(const TableOneResult& result);
Figure distributionFigure(const TableOneResult& result, const ErrorSamples& samples);
Figure axesFigure(const TableOneResult& result, const ErrorSamples& samples);
Figure foldsFigure(const TableOneResult& result);
Figure calibrationFigure(const TableOneResult& result, const ErrorSamples& samples);

}  // namespace raven_correction
