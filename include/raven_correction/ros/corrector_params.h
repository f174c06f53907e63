// SPDX-License-Identifier: BSD-3-Clause
// Parameters of the node `corrector` (config/corrector.yaml says what each means), and whether a
// model is for the arm that they describe.
#pragma once

#include <ros/node_handle.h>

#include <string>
#include <vector>

#include "raven_correction/correction/corrector.h"
#include "raven_correction/evaluation/preflight.h"

namespace raven_correction {

/// One arm. With a single arm its parameters are those of the node (or of its namespace, if it has
/// one); with two, each has a namespace of its own below it and has to say whose models it takes.
struct CorrectedArmParams {
  std::string name;   ///< in arm_names of a RavenCommand; empty: the message has one pose
  std::string ns;     ///< of its topics and parameters, below those of the node; empty: the same
  std::string arm;    ///< whose models are taken; empty: not checked
  std::string tool;   ///< with which it was recorded; empty: not checked
  std::string model;  ///< file to start with; empty: wait for the topic
  std::string robot;  ///< kinematic chain (config/robots) for the limits of the joints; empty: none
};

struct CorrectorParams {
  std::string base_frame = "0_link";      ///< the only frame that is accepted
  bool allow_empty_frame = false;         ///< no frame means the base frame
  std::string pose_type = "PoseStamped";  ///< of desired/servo_cp and servo_cp: commandTypes()
  std::string mode = "full";              ///< that ~enable switches on
  bool enabled = false;                   ///< at start
  double gain = 1.0;                      ///< share of the correction that is applied [-]
  CorrectorLimits limits;                 ///< without the chain
  std::string robot_state_topic;          ///< enabled and homed? empty: not asked
  double robot_state_timeout = 1.0;       ///< an older state is not known any more [s]
  bool watch_output = true;               ///< ask the master who else publishes the output
  int realtime_priority = 0;              ///< of the threads on a pose's way; 0: none
  bool lookahead = true;                  ///< correct for the pose ahead on an announced path
  bool require_preflight = false;         ///< before a model may be switched on
  PreflightLimits preflight;              ///< what it has to keep
  double preflight_duration = 60.0;       ///< of moves that are observed, at most [s]
  int preflight_poses = 1000;             ///< observed while commanded, that end it earlier [1]
  std::string mocap_pose_type = "PoseStamped";  ///< message of mocap/measured_cp: poseTypes()
  std::string mocap_frame;               ///< of its messages that name none; empty: not known
  std::string mocap_stamp = "header";    ///< header, or receipt
  std::vector<CorrectedArmParams> arms;  ///< one or two
};
/// @throws InvalidInput  lists every problem
CorrectorParams loadCorrectorParams(const ros::NodeHandle& nh);

/// @param now  Unix time [s]
/// Units are the business of modelFromMsg().
/// @throws InvalidInput  the model is of another frame, arm, tool or message type, does not say for
///                       which arm or tool although one is asked for, or has expired; the text says
///                       which, and what to do
void checkModelIsFor(const Correction& model, const CorrectorParams& params,
                     const CorrectedArmParams& arm, double now);

}  // namespace raven_correction
