// SPDX-License-Identifier: BSD-3-Clause
// Checks before trust: whether the streams of a session are what they are taken for, and belong
// together. Frames, units, rates, clocks, order, and which arm they are of. How regularly a
// recording was sampled is stream_health.h; which pairs are worth learning from is the room
// `cleaning`.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "raven_correction/dataset/stream_finding.h"
#include "raven_correction/dataset/trajectory.h"

namespace raven_correction {

/// Where the tool of one arm is by its joints: what tells the arms apart.
struct ArmKinematics {
  std::string name;
  /// @param positions  one for each name [rad or m]
  /// @return the tool in base; nothing where a joint of the arm is not among the names
  std::function<std::optional<Pose>(const std::vector<std::string>& names,
                                    const Eigen::VectorXd& positions)>
      forward;
};

enum class StreamRole { kCommands, kObservations, kEncoders, kJoints };
constexpr std::size_t kStreamRoles = 4;

struct StreamCheckOptions {
  std::array<std::string, kStreamRoles> names{"commands", "observations", "encoders", "joints"};
  /// Of commands and encoders; empty: any single one.
  std::string base_frame;
  std::size_t window = 0;              ///< newest samples of each stream that count [1]; 0: all
  double max_distance = 2.0;           ///< of the tool from the origin of base, median [m]
  double max_camera_distance = 20.0;   ///< of the tool from that of any other frame, median [m]
  double min_rate = 5.0;               ///< [1/s]
  double pause = 0.5;                  ///< a longer interval is a pause between two motions [s]
  double max_gap_share = 0.3;          ///< of the time in intervals above 3 medians [-]
  double max_ahead = 0.05;             ///< of stamps before the clock here, median [s]
  double max_age = 0.5;                ///< of stamps behind the clock here, median [s]
  double max_clock = 5.0;              ///< further off is an error, not a warning [s]
  double max_kinematics_error = 0.01;  ///< encoders against joints, median [m]
  double max_kinematics_angle = 0.2;   ///< [rad]
  double max_error = 0.15;             ///< of observations from commands, median [m]
  /// Of the commanded motion: what the best rigid transform at the best delay leaves [-].
  double max_unexplained = 0.6;
  double min_delay = -0.3, max_delay = 0.7;  ///< of observations behind commands, searched [s]
  std::vector<ArmKinematics> arms;           ///< the first is the one this is taken for
};

/// Collects samples as they come, live or from a recording, and says what is wrong with them.
/// Not thread-safe; a copy is what another thread may look at.
class StreamCheck {
 public:
  explicit StreamCheck(StreamCheckOptions options);

  /// @param stamp    of the message; 0: not set [s]
  /// @param arrival  when it came, by the clock here; nan: not known [s]
  /// @param frame    as sent
  /// @param pose     as sent
  /// @param X_base_frame  registration of the frame; null: not known
  void addPose(StreamRole role, double stamp, double arrival, std::string_view frame,
               const Pose& pose, const Pose* X_base_frame);
  void addJoints(double stamp, double arrival, const std::vector<std::string>& names,
                 const Eigen::VectorXd& positions);
  /// The next samples are of another trajectory, whose stamps may lie anywhere.
  void startTrajectory();
  /// Forgets all samples.
  void clear();
  std::size_t count(StreamRole role) const { return track(role).count; }  ///< since clear()

  /// Of each stream by itself, and of joints against encoders. A stream without a sample is no
  /// finding: whether it has to be there is the caller's business.
  std::vector<StreamFinding> findings() const;
  /// The same, and whether observations follow commands (checkFollowing()) in what is in the
  /// window. Some 50 ms: not in a callback.
  std::vector<StreamFinding> allFindings() const;

 private:
  enum class Value : std::uint8_t { kGood, kNotFinite, kNotUnit, kIdentity };
  struct Sample {
    double stamp = 0.0, arrival = 0.0;
    double interval = 0.0;  // since the sample before; 0: none, or another trajectory [s]
    double distance = 0.0;  // from the origin of its own frame [m]
    bool repeated = false;
    Value value = Value::kGood;
    std::uint8_t frame = 0;  // index into Track::frames
    Pose base;               // in base, where that is known
    bool placed = false;
    Eigen::VectorXd joints;
  };
  struct Track {
    std::size_t count = 0;
    std::vector<std::string> frames;  // that were named; those of the window: framesOf()
    std::vector<std::string> joint_names;
    double last_stamp = 0.0;  // 0: none in this trajectory
    Pose last_pose;
    bool has_last_pose = false;
    std::deque<Sample> samples;
  };
  const Track& track(StreamRole role) const { return tracks_[static_cast<std::size_t>(role)]; }
  const std::string& name(StreamRole role) const {
    return options_.names[static_cast<std::size_t>(role)];
  }
  static std::size_t countOf(const Track& track, Value value);
  /// Of the samples that count.
  static std::vector<std::string> framesOf(const Track& track);
  Sample& take(Track& track, double stamp, double arrival);
  void checkStamps(StreamRole role, std::vector<StreamFinding>& findings) const;
  void checkClock(StreamRole role, std::vector<StreamFinding>& findings) const;
  void checkValues(StreamRole role, std::vector<StreamFinding>& findings) const;
  void checkFrame(StreamRole role, std::vector<StreamFinding>& findings) const;
  void checkUnits(StreamRole role, std::vector<StreamFinding>& findings) const;
  void checkJointUnits(std::vector<StreamFinding>& findings) const;
  void checkArm(std::vector<StreamFinding>& findings) const;
  PoseStream placed(StreamRole role) const;

  StreamCheckOptions options_;
  std::array<Track, kStreamRoles> tracks_;
};

/// Whether observations follow commands: how far apart they are, whether the best rigid transform
/// at the best delay explains the motion (markers of another tool, another arm), whether they come
/// before what they follow (clocks), and whether one of them is in other units. Nothing is said
/// where there is too little motion to tell.
void checkFollowing(const Dataset& dataset, const StreamCheckOptions& options,
                    std::vector<StreamFinding>& findings);

/// All of the above for a recording: commands and observations have to be there.
std::vector<StreamFinding> checkDataset(const Dataset& dataset, const StreamCheckOptions& options);

}  // namespace raven_correction
