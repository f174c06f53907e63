// SPDX-License-Identifier: BSD-3-Clause
// The node `recorder`: takes what is commanded and what is seen, writes it to bags as doc/bags.md
// says, and publishes synchronised pairs while it happens. Disk work is session_writer.h.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <geometry_msgs/PoseStamped.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <tf2_msgs/TFMessage.h>

#include <array>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "raven_correction/CorrectionModel.h"
#include "raven_correction/RecorderStatus.h"
#include "raven_correction/StartRecording.h"
#include "raven_correction/StopRecording.h"
#include "raven_correction/TrajectoryEvent.h"
#include "raven_correction/ros/delay_watch.h"
#include "raven_correction/ros/homing_watch.h"
#include "raven_correction/ros/live_synchroniser.h"
#include "raven_correction/ros/registration.h"
#include "raven_correction/ros/session_writer.h"
#include "raven_correction/ros/stamp_order.h"
#include "raven_correction/ros/stream_watch.h"
#include "raven_correction/ros/trajectory_windows.h"

namespace raven_correction {

struct RecorderParams {
  std::string directory;                  ///< of the bags, absolute; default $HOME/raven_sessions
  bool auto_start = false;                ///< start a recording at once
  std::string base_frame = "0_link";      ///< frame of the native controller
  std::string pose_type = "PoseStamped";  ///< message of servo_cp, desired/servo_cp, measured_cp
  std::string command_type = "same";      ///< message of both command topics; same: as pose_type
  std::string command_arm;                ///< arm of a RavenCommand
  std::string mocap_pose_type = "same";   ///< message of mocap/measured_cp; same: as pose_type
  std::string mocap_frame;  ///< frame of motion capture messages that name none; empty: unknown
  std::string mocap_stamp = "header";  ///< header, or receipt for drivers that leave it empty
  std::string robot_state_topic;       ///< says when the robot is homed; empty: not asked
  double robot_state_timeout = 1.0;    ///< states are no further apart [s]
  std::string robot_state_arm;    ///< whose pose and joints are taken from it; empty: from topics
  std::string robot_state_frame;  ///< of its poses where they name none; empty: base_frame
  std::string robot;              ///< chain of this arm, for the checks; empty: not checked
  std::vector<std::string> other_robots;  ///< chains of arms it could be mixed up with
  LiveSynchroniserOptions pairs;
  DelayWatchOptions delay;
  double split_size_mb = 0.0;    ///< a part is closed at this size [1e6 byte]; 0: never
  double split_duration = 0.0;   ///< a part is closed after this time [s]; 0: never
  double min_free_mb = 1000.0;   ///< the recording ends below this free space [1e6 byte]
  int queue_size = 100000;       ///< messages that may wait for the disk [1]
  int subscriber_queue = 20000;  ///< messages per topic that may wait for the node [1]
};

/// @param nh  private node handle
/// @throws InvalidInput  lists every problem
RecorderParams loadRecorderParams(const ros::NodeHandle& nh);

/// The same as YAML text, with the version of the package: what stands in every bag.
std::string recorderParametersYaml(const RecorderParams& params);

/// All callbacks run in the one thread that spins; the disk has a thread of its own.
class Recorder {
 public:
  /// @param nh          names of topics are relative to it
  /// @param private_nh  status and services
  /// @throws InvalidInput  auto_start is set and a recording cannot begin
  Recorder(ros::NodeHandle nh, ros::NodeHandle private_nh, const RecorderParams& params);
  ~Recorder();  ///< closes a running recording in good order

 private:
  enum Stream {
    kCommand,
    kDesired,
    kMocap,
    kEncoder,
    kJoints,
    kJawCommand,
    kJaw,
    kEvents,
    kStreamCount
  };
  struct StreamState {
    std::string topic;  // relative: its name in the bag
    ros::Subscriber subscriber;
    std::uint64_t received = 0;      // since the start of the recording
    StampOrder order;                // of what was recorded since then
    std::uint64_t at_last_look = 0;  // of `heard`, for the rate in diagnostics
    std::uint64_t heard = 0;         // since the node started
    ros::SteadyTime last;            // when the latest arrived; zero: none yet
  };

  void onCommand(const geometry_msgs::PoseStampedConstPtr& message);
  void onDesired(const geometry_msgs::PoseStampedConstPtr& message);
  void onMocap(const geometry_msgs::PoseStampedConstPtr& message);
  void onEncoder(const geometry_msgs::PoseStampedConstPtr& message);
  void onEvent(const TrajectoryEventConstPtr& message);
  void onJoints(Stream stream, const sensor_msgs::JointStateConstPtr& message);
  void onRobotState(const ros::MessageEvent<AnyMessage const>& event);
  void onStaticTransforms(const tf2_msgs::TFMessageConstPtr& message);
  bool onStart(StartRecording::Request& request, StartRecording::Response& response);
  bool onStop(StopRecording::Request& request, StopRecording::Response& response);
  void onTimer();

  bool running() const;                        // being written to the disk
  std::string start(const std::string& name);  // @return path of the first part; may throw
  std::string newName() const;
  /// Counts a message; @return when it was received.
  ros::Time note(Stream stream);
  template <typename Message>
  void record(Stream stream, const ros::Time& time, const boost::shared_ptr<const Message>& m);
  void leaveOut(const std::string& topic, const ros::Time& stamp, double back);
  void recordStaticTransforms(const ros::Time& time);
  void recordParameters(const ros::Time& time);
  void recordHoming(const ros::Time& time);
  void recordRegistration(const std::string& frame, const Pose& X_base_frame, const ros::Time& now);
  geometry_msgs::PoseStampedConstPtr withBaseFrame(const geometry_msgs::PoseStampedConstPtr& m);
  void publishPairs(const std::vector<LivePair>& pairs);
  void watchClock(const ros::Time& now);
  void forgetSamples();
  /// Hands a pose on to the checks; @return its registration
  std::optional<Pose> check(StreamRole role, const ros::Time& arrival,
                            const geometry_msgs::PoseStamped& message);
  void startChecks();
  void warnOfFindings();
  void warnUnregistered(const std::string& topic, const std::string& frame);
  static double since(const ros::SteadyTime& then);  // [s]
  RecorderStatus status() const;
  void publishStatus();
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& report);

  ros::NodeHandle nh_;
  RecorderParams params_;
  Registration registration_;
  StaticTransforms static_transforms_;
  LiveSynchroniser synchroniser_;
  DelayWatch delay_;
  std::unique_ptr<StreamWatch> watch_;
  std::set<std::string> warned_of_;  // stream and kind of findings
  HomingWatch homing_watch_;
  ros::Time homed_at_;  // of the last homing that was seen, or may have been; zero: none
  bool robot_state_warned_ = false;
  TrajectoryWindows trajectories_;

  std::unique_ptr<SessionWriter> writer_;  // of the current or the last recording
  bool recording_ = false;                 // between ~start and ~stop, even if the disk is full
  ros::SteadyTime started_;
  double duration_ = 0.0;  // of the last recording [s]
  std::uint32_t completed_trajectories_ = 0;
  std::uint64_t pairs_ = 0;
  StampOrder pair_order_;
  std::uint64_t out_of_order_ = 0;  // left out of the bag
  std::string order_message_;       // of the first that was left out; empty: none
  std::uint64_t free_bytes_ = 0;    // before the first recording [byte]

  std::array<StreamState, kStreamCount> streams_;
  ros::Time last_time_;
  std::string clock_message_;         // of the last backward jump; empty: none
  std::string unregistered_message_;  // as long as it is true; empty: registered
  ros::SteadyTime last_warning_, last_diagnosis_, last_status_;
  RecorderStatus published_;  // the last status

  ros::Publisher pairs_publisher_, status_publisher_;
  diagnostic_updater::Updater diagnostics_;
  ros::Subscriber static_transforms_subscriber_, robot_state_subscriber_, model_subscriber_;
  ros::ServiceServer start_service_, stop_service_;
  ros::WallTimer timer_;
};

}  // namespace raven_correction
