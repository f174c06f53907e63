// SPDX-License-Identifier: BSD-3-Clause
// What the reports share: units for people, and the JSON of cleaning.
#pragma once

#include <nlohmann/json.hpp>

#include "raven_correction/dataset/synchronisation.h"

namespace raven_correction {

using Json = nlohmann::ordered_json;

constexpr double kDegree = 180.0 / 3.14159265358979323846;  ///< deg per rad
constexpr double kMillimetre = 1e3;                         ///< mm per m
constexpr double kPercent = 100.0;

inline const char* const kVariables[6] = {"tx", "ty", "tz", "yaw", "pitch", "roll"};
inline double unitOf(int variable) { return variable < 3 ? kMillimetre : kDegree; }
inline const char* unitName(int variable) { return variable < 3 ? "mm" : "deg"; }

/// {"tx_mm", "ty_mm", "tz_mm", "yaw_deg", "pitch_deg", "roll_deg"}
Json componentsJson(const Eigen::Matrix<double, 6, 1>& values);
/// {"total", "kept", "rejected": {reason: count}, "identity_commands"}
Json cleaningJson(const FateCounts& fates, std::size_t identity_commands);

}  // namespace raven_correction
