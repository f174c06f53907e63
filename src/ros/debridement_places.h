// SPDX-License-Identifier: BSD-3-Clause
// Where the arms of the debridement experiment are, and where their field is.
#pragma once

#include <Eigen/Core>

#include "raven_correction/simulation/debridement_task.h"

namespace raven_correction {

struct ArmPlace {
  const char* ns;     ///< namespace of its nodes
  const char* name;   ///< for people
  const char* robot;  ///< its file in the package
  Eigen::Vector3d p_base_receptacle;
  double lower, upper;  ///< part of the field that they share, x in the frame of the field [m]
};

constexpr unsigned kMostArms = 2;
/// Two arms share a field between them; one alone has a field in front of it.
inline const ArmPlace& placeOf(unsigned arm) {
  static const ArmPlace places[kMostArms] = {{"/raven/left",
                                              "left",
                                              "config/robots/raven2_left.yaml",
                                              {-0.020, -0.0203, -0.105},
                                              0.0,
                                              1.0},
                                             {"/raven/right",
                                              "right",
                                              "config/robots/raven2_right.yaml",
                                              {-0.1286, -0.0203, -0.105},
                                              -1.0,
                                              0.0}};
  return places[arm];
}

/// Middle of the platform in the base frame that the arms share.
inline Pose fieldOf(unsigned arms) {
  constexpr double kPlatform = -0.170;  // height of its surface [m]
  return {{arms == 1 ? -0.020 : -0.0743, -0.058, kPlatform}, Eigen::Quaterniond::Identity()};
}

inline DebridementTaskConfig taskOf(unsigned arm, unsigned arms) {
  DebridementTaskConfig task;
  task.X_base_field = fieldOf(arms);
  task.X_base_rest = {placeOf(arm).p_base_receptacle, task.orientation.normalized()};
  return task;
}

}  // namespace raven_correction
