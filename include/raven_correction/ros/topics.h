// SPDX-License-Identifier: BSD-3-Clause
// Names of the topics, in one place. All relative, so that the caller's namespace is the arm; the
// same names are the topics of a session's bag (doc/bags.md).
#pragma once

namespace raven_correction {
namespace topics {

constexpr char kCommand[] = "servo_cp";          ///< command to the native controller
constexpr char kDesired[] = "desired/servo_cp";  ///< from the planner, before correction
constexpr char kDesiredPath[] = "desired/path";  ///< PoseArray: the whole motion that follows
constexpr char kMocap[] = "mocap/measured_cp";   ///< motion capture, not registered
constexpr char kEncoder[] = "measured_cp";       ///< forward kinematics of the encoders
constexpr char kSetpoint[] = "setpoint_cp";      ///< what the controller aims at
constexpr char kJoints[] = "measured_js";        ///< joint positions from the encoders
constexpr char kJawCommand[] = "jaw/servo_jp";   ///< opening of the jaw, to the controller
constexpr char kJaw[] = "jaw/measured_js";       ///< opening of the jaw
constexpr char kPairs[] = "pairs";               ///< synchronised, live
constexpr char kTrajectoryEvent[] = "trajectory_event";  ///< start and end of trajectories
constexpr char kModel[] = "correction/model";            ///< latched
constexpr char kStatus[] = "correction/status";          ///< one per desired pose
constexpr char kSamples[] = "correction/samples";        ///< of the training, latched
constexpr char kOverlay[] = "overlay";                   ///< markers for rviz
constexpr char kOverlayModel[] = "overlay_model";        ///< of the model, latched
constexpr char kLeftImage[] = "left/image_raw";          ///< of the stereo camera over the field
constexpr char kLeftInfo[] = "left/camera_info";         ///< its calibration
constexpr char kRightImage[] = "right/image_raw";        ///< with the stamp of the left one
constexpr char kRightInfo[] = "right/camera_info";
constexpr char kFragments[] = "fragments";            ///< FragmentArray: what lies on the field
constexpr char kFragmentPoses[] = "fragments/poses";  ///< PoseArray of the same, for rviz
constexpr char kFragmentImage[] = "fragments/image";  ///< drawn into the left image, for people
constexpr char kRecorderParameters[] = "recorder/parameters";  ///< in bags only
constexpr char kRobotHomed[] = "robot_homed";                  ///< in bags only: last homing
constexpr char kTfStatic[] = "/tf_static";                     ///< registration

}  // namespace topics
}  // namespace raven_correction
