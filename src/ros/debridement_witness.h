// SPDX-License-Identifier: BSD-3-Clause
// What the nodes of the debridement experiment say of the truth while the arms work: every jaw that
// closed or let go, and how near the instruments came to each other.
#pragma once

#include <ros/ros.h>

#include <array>
#include <fstream>
#include <limits>
#include <mutex>
#include <string>
#include <vector>

#include "raven_correction/CorrectionStatus.h"
#include "raven_correction/GraspResult.h"
#include "raven_correction/report/debridement_report.h"

namespace raven_correction {

/// Thread-safe; needs somebody who spins.
class DebridementWitness {
 public:
  /// @param arms               namespaces, each with a corrector
  /// @param camera, simulator  names of the nodes
  /// @param file               every jaw is written to it (CSV)
  DebridementWitness(const std::vector<std::string>& arms, const std::string& camera,
                     const std::string& simulator, const std::string& file);
  void begin(const std::string& condition);
  void begin(std::uint64_t scene);
  /// Of the scene. @param outcome  of GraspResult
  unsigned count(std::uint8_t outcome) const;
  /// Smallest distance of the instruments in the condition; infinite for one arm [m].
  double clearance() const;
  CorrectedPoses poses() const;  ///< in the condition

 private:
  void onGrasp(const GraspResult& message);
  void onStatus(const CorrectionStatus& status);

  mutable std::mutex mutex_;  // guards what follows
  std::ofstream table_;
  std::string condition_;
  std::uint64_t scene_ = 0;
  std::array<unsigned, 6> counts_{};
  double clearance_ = std::numeric_limits<double>::infinity();
  CorrectedPoses poses_;
  std::vector<ros::Subscriber> subscribers_;  // last: callbacks use all of the above
};

}  // namespace raven_correction
