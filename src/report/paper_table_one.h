// SPDX-License-Identifier: BSD-3-Clause
// Table I as printed in the paper, to be set beside what was run.
// Source: Mahler et al. 2014, section V-B, Table I
#pragma once

#include "raven_correction/evaluation/table_one.h"

namespace raven_correction {

constexpr Method kMethods[6] = {
    Method::kNone,    Method::kRigid,           Method::kRigidClean,
    Method::kRigidGp, Method::kRigidGpVelocity, Method::kRigidGpVelocityClean};

/// Of the process: position in the base frame, rotation vector.
inline const char* const kOutputs[6] = {"dx", "dy", "dz", "rx", "ry", "rz"};

/// "rigid + GP + velocity"
const char* methodWords(Method method) noexcept;

struct MeanStd {
  double mean, std;
};
/// mm and deg: variables (tx ty tz yaw pitch roll) in rows, methods in columns.
using PaperTable = MeanStd[6][6];
const PaperTable& paperTable(bool clean) noexcept;

/// Norm of the three means from row `first` (0: mm, 3: deg) on.
double paperNorm(const PaperTable& table, int method, int first);

/// In the order of the table.
std::vector<std::string> configurationsOf(const TableOneResult& result);

}  // namespace raven_correction
