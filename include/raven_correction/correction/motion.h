// SPDX-License-Identifier: BSD-3-Clause
// What the correction knows of a motion at one instant: the pose and, from the past, how it got
// there. One piece of code computes it in training, offline and live. How it becomes the features
// of the Gaussian process is model.h.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "raven_correction/geometry/stream.h"
#include "raven_correction/robot/inverse_kinematics.h"

namespace raven_correction {

enum class VelocityKind {
  kNone,     ///< pose only
  kCentral,  ///< one twist, the five-point stencil of the paper; looks ahead: offline only
  kCausal,   ///< one twist, the least-squares slope over the past `window`
  kPast,     ///< several twists, the mean velocities over successive intervals of the past
};
/// "none", "central", "causal", "past".
/// @throws InvalidInput  for any other name
VelocityKind velocityFromName(const std::string& name);
const char* velocityName(VelocityKind kind) noexcept;

constexpr std::size_t kMaxTwists = 4;

struct MotionOptions {
  VelocityKind velocity = VelocityKind::kPast;
  double window = 0.1;  ///< kCausal: duration of the slope, > 0 [s]
  /// kPast: how long before the sample each interval begins, increasing, > 0; the first interval
  /// ends at the sample, every other where the one before it begins. [s]
  std::vector<double> intervals{0.05, 0.15, 0.4};
  double max_gap = 0.15;  ///< a longer time between samples starts a new motion [s]
  /// How far the pose gets ahead of the follower of Motion::play, >= 0; both zero: there is none.
  double play_length = 0.0;  ///< [m]
  double play_angle = 0.0;   ///< [rad]
  /// Where the robot is known, Motion::joint_play takes the place of Motion::play: text of its
  /// robot file (robot/chain_file.h), six joints; empty: not known.
  std::string robot;
  double joint_play_length = 0.002;  ///< half width of the play of a prismatic joint, > 0 [m]
  double joint_play_angle = 0.02;    ///< the same of the first two revolute joints [rad]
  double joint_play_wrist = 0.1;     ///< and of the other revolute ones [rad]
};
/// @throws InvalidInput  an option is out of its range, there are more than kMaxTwists intervals,
/// or
///         the robot's text cannot be read or has not six joints
void checkMotionOptions(const MotionOptions& options);
/// Motion::joint_play is a part of what is known.
bool hasJointPlay(const MotionOptions& options) noexcept;
/// Motion::play or Motion::joint_play is.
bool hasPlay(const MotionOptions& options) noexcept;
/// Number of twists in a Motion: intervals for kPast, none for kNone, otherwise one.
std::size_t twistCount(const MotionOptions& options) noexcept;

/// From one pose to another, both parts expressed in the base frame.
struct Displacement {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  ///< of the origin [m]
  Eigen::Vector3d r = Eigen::Vector3d::Zero();  ///< rotation vector [rad]
};

/// Pose, twists and play at one instant, in one frame.
struct Motion {
  Pose pose;
  std::array<Twist, kMaxTwists> twists;  ///< the first twistCount() are set
  /// From where a follower is that is dragged along behind the tool, on a string of length
  /// play_length (for the position) and play_angle (for the orientation): the direction in which
  /// the tool has come, which it still has at rest, where there is no velocity. Friction and
  /// backlash depend on it. Zero where there is no play, and before the tool has moved.
  Displacement play;
  /// The same joint by joint, which is where friction and backlash are: -1 where the joint has come
  /// down at least the width of its play, 1 where it has come up, between them where it has turned
  /// round since; of the joints that the robot needs to be where the tool is. [-]
  Eigen::Matrix<double, 6, 1> joint_play = Eigen::Matrix<double, 6, 1>::Zero();
  double step = 0.0;  ///< since the sample before [s]; 0 for the first of a motion
};

/// Follows a stream of poses sample by sample, with bounded memory and without allocation.
///
///   kCausal  causalTwist() of differentiation.h
///   kPast    twist k = (x(t - a) - x(t - b)) / (b - a) over [t - b, t - a], interval k: x is the
///            position, or the rotation vector relative to the present orientation, interpolated
///            between samples; before its first sample a motion was at rest
///   kCentral has no live form: it is answered as kCausal
///
///   play     vector play operator: the follower z stays where it is while |x - z| <= length, and
///   is
///            else pulled towards x until |x - z| = length. It stays in the pauses between motions,
///            too; a move that nobody saw counts as a straight one.
///            Source: Brokate, Sprekels 1996, doi:10.1007/978-1-4612-4048-8
///   joints   a scalar play operator for each; a pose that the robot does not reach moves none
class MotionEstimator {
 public:
  explicit MotionEstimator(const MotionOptions& options);

  enum class Outcome {
    kAccepted,   ///< motion() is of this sample
    kRepeated,   ///< same stamp as the sample before: nothing new, motion() is unchanged
    kBackwards,  ///< stamp before the last one: refused, nothing changed
    kNotFinite,  ///< stamp or pose is not finite: refused, nothing changed
    kNotUnit,    ///< quaternion not of unit length: refused, nothing changed
  };
  Outcome push(double stamp, const Pose& pose) noexcept;
  /// Takes back the last push(), which was accepted: as if that sample had never come.
  void undo() noexcept;
  /// Of the last accepted sample.
  const Motion& motion() const noexcept { return motion_; }
  /// Goes on with the motion that another one has followed, as far back as it remembers and
  /// max_gap allows, and with its follower of the play (without one: dragged along what it
  /// remembers); motion() is of the next sample.
  void takeOver(const MotionEstimator& other) noexcept;
  /// The next sample is the first of another motion of the same tool; its stamp may be any.
  void startMotion() noexcept;
  /// Forgets everything, also where the follower of the play is.
  void reset() noexcept;

 private:
  void remember(const StampedPose& sample) noexcept;
  void pastTwists() noexcept;
  void drag() noexcept;
  void dragPose() noexcept;
  void dragJoints() noexcept;

  static constexpr std::size_t kCapacity = 1024;  ///< samples remembered
  MotionOptions options_;
  double thinning_ = 0.0;             ///< samples closer than this share one place [s]
  std::vector<StampedPose> samples_;  ///< room for 2 kCapacity; the first count_ are the history
  std::size_t count_ = 0;
  double last_stamp_ = 0.0;
  bool started_ = false;
  std::shared_ptr<const InverseKinematics> joints_of_;  ///< null: the robot is not known
  JointVector play_width_;                              ///< half of it, per joint [rad, m]
  struct Follower {                                     ///< of the play
    bool dragged = false;                               ///< there is one
    Pose pose;
    JointVector joints;  ///< the robot's, at the newest pose that it reaches [rad, m]
    JointVector slack;   ///< by how much they are ahead of their followers [rad, m]
  } follower_;
  Motion motion_;
  struct Undo {  ///< what the last sample has overwritten
    std::size_t count = 0, place = 0;
    StampedPose replaced;
    double last_stamp = 0.0;
    bool started = false;
    Motion motion;
    Follower follower;
  } undo_;
};

/// The motions of all samples of a recorded stream; kCentral looks ahead within each motion.
/// @param stream     stamps strictly increasing
/// @param estimator  of these options, that knows of the motions before: goes on with another one
std::vector<Motion> motionsOf(const PoseStream& stream, const MotionOptions& options,
                              MotionEstimator& estimator);
/// The same where nothing is known of the time before.
std::vector<Motion> motionsOf(const PoseStream& stream, const MotionOptions& options);

}  // namespace raven_correction
