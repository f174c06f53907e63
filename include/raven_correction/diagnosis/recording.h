// SPDX-License-Identifier: BSD-3-Clause
// A measured session as a simulation sees it: the joint set-points that drove the robot, and what
// was seen meanwhile, cleaned of samples that cannot be real. Running a simulation on it is
// residual.h; the streams as they were recorded are dataset/trajectory.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raven_correction/dataset/trajectory.h"
#include "raven_correction/robot/kinematic_chain.h"

namespace raven_correction {

/// What drives the simulation.
enum class DriveSource {
  kCommands,  ///< what was sent to the controller; everything from there to the cameras is
              ///< simulated
  kEncoders,  ///< where the encoders were; only what lies behind the motors is simulated
};

struct RecordingOptions {
  DriveSource source = DriveSource::kCommands;
  /// With kCommands: encoder streams, where there are any, are observations, too. They see the
  /// drives and not the cables, and so tell one from the other.
  bool use_encoders = true;
  /// Observed orientations further from their mean cannot be real: markers taken for one another.
  /// Not applied where more than a tenth would go: such a tool does turn that far.
  double orientation_window = 1.0471975511965976;  ///< 60 deg [rad]
  double max_speed = 0.6;          ///< of the observed tool between two frames [m/s]; 0: any
  std::size_t max_samples = 4000;  ///< about so many observations are kept, evenly spread; 0: all
};

/// Plain data; what was left out, and why, is counted.
struct Recording {
  struct Setpoint {
    double stamp = 0.0;  ///< [s]
    JointVector joints;  ///< [rad or m]
  };
  struct Observation {
    enum class Kind {
      kPose,     ///< of the tool, by motion capture
      kJoints,   ///< of the links, by whatever saw them: recordings without kinematics
      kEncoders  ///< of the motors, in joint units
    };
    double stamp = 0.0;  ///< [s]
    Kind kind = Kind::kPose;
    Pose pose;           ///< X_base_tool, of kPose
    JointVector joints;  ///< of the other two [rad or m]
  };
  /// One trajectory of the data set.
  struct Motion {
    std::string id;
    std::vector<Setpoint> setpoints;  ///< by stamp, at least one
    /// So many of the first set-points the motion before has had already: this one is a block of
    /// the same motion, and goes on where that one ends (blocks.h).
    std::size_t carried = 0;
    std::vector<Observation> observations;  ///< by stamp
    /// Runs of three consecutive frames of each kind, as they were before thinning, by stamp: what
    /// the noise from frame to frame is seen in (noise_floor.h). So many, whatever max_samples is.
    std::vector<Observation> frames;
  };
  std::string name;
  DriveSource source = DriveSource::kCommands;
  KinematicChain robot;        ///< for joint data: one row per joint, without any geometry
  bool has_kinematics = true;  ///< false: joint data, robot's geometry means nothing
  bool has_encoders = false;   ///< some observations are kEncoders
  std::vector<Motion> motions;
  struct Left {                                   ///< out of how many samples, and why
    std::size_t setpoints = 0, observations = 0;  ///< given
    std::size_t outside_limits = 0;  ///< set-points: brought to the limit, as the controller does
    std::size_t unreachable = 0;     ///< set-points: no joints reproduce the pose
    std::size_t not_a_command = 0;   ///< set-points: not finite, not unit, identity
    std::size_t repeated = 0;        ///< observations: the frame before again
    std::size_t impossible = 0;      ///< observations: not finite, orientation or speed
    std::size_t thinned = 0;         ///< observations: more than max_samples
  } left_out;
};

/// Pose streams become set-points by nominal inverse kinematics, seeded along the stream.
/// @param robot  nominal chain of the data set's arm
/// @throws InvalidInput  no trajectory has both what drives and what was observed; the poses of the
///         data set are in another frame than the robot's; no command can be reached, or
///         most are outside the joint limits; several sessions (sessionStarts())
Recording makeRecording(const Dataset& dataset, const KinematicChain& robot,
                        const RecordingOptions& options);

/// Joint streams of any robot. `prismatic` joints are in metres, the others in radians.
/// The rows of its robot are called as the joints of the stream; homing positions are the medians
/// of the commands, because a joint stream does not say where home is.
/// @param prismatic  one per joint name of the command stream
/// @throws InvalidInput  as above; commands and observations name other joints; too many joints
Recording makeJointRecording(const Dataset& dataset, const std::vector<bool>& prismatic,
                             const RecordingOptions& options);

/// True for a data set of joint streams only.
bool isJointData(const Dataset& dataset) noexcept;

}  // namespace raven_correction
