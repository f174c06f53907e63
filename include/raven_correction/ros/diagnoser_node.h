// SPDX-License-Identifier: BSD-3-Clause
// The diagnoser: a service that names the physical causes of what a simulation gets wrong about
// recorded sessions, progress meanwhile, and the verdict on a latched topic. What a diagnosis does
// is diagnosis/diagnose.h.
#pragma once

#include <raven_correction/Diagnose.h>
#include <raven_correction/DiagnosisVerdict.h>
#include <ros/ros.h>

#include <string>
#include <vector>

#include "raven_correction/ros/diagnosis_job.h"
#include "raven_correction/ros/long_work.h"
#include "raven_correction/ros/params.h"

namespace raven_correction {

struct DiagnoserParams {
  std::string data_directory = "~/raven_sessions";           ///< where recordings are
  std::string simulation_directory = "~/raven_simulations";  ///< where extended ones are written
  std::string simulation;  ///< what is believed so far; empty: config/simulation/nominal.yaml
};
/// `~` at the start of a directory becomes $HOME.
/// @throws InvalidInput  lists every problem
DiagnoserParams loadDiagnoserParams(const ros::NodeHandle& nh);

/// Services are called from several threads (AsyncSpinner); one diagnosis runs at a time.
class DiagnoserNode {
 public:
  /// @throws InvalidInput  see loadDiagnoserParams() and loadSimulationConfig()
  DiagnoserNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh);

 private:
  bool onDiagnose(Diagnose::Request& request, Diagnose::Response& response);
  void diagnoseRequest(const Diagnose::Request& request, Diagnose::Response& response);

  ros::NodeHandle nh_, private_nh_;
  DiagnoserParams params_;
  LongWork work_;
  ros::Publisher verdict_publisher_;
  // Declared last: its callback uses everything above.
  ros::ServiceServer diagnose_service_;
};

}  // namespace raven_correction
