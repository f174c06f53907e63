// SPDX-License-Identifier: BSD-3-Clause
// Debridement by one arm, step by step: choose a fragment, go over it, down, close the jaw, up,
// look whether it is gone, or its neighbour instead, carry what is held to the receptacle; or try
// again. Knows neither ROS nor a
// simulator: what it sees and moves is an interface. Motions without fragments are
// debridement_motion.h.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "raven_correction/geometry/pose.h"
#include "raven_correction/simulation/fragment_book.h"

namespace raven_correction {

/// The arm and the camera of a task. Calls return when what they ask for is done.
class DebridementCell {
 public:
  virtual ~DebridementCell() = default;
  virtual double now() = 0;  ///< [s]
  /// A straight motion to rest there, and `dwell` seconds at rest: one trajectory.
  virtual void move(const char* kind, const Pose& X_base_tool, double dwell) = 0;
  /// The jaw goes to this opening [rad]; the tool stays for `dwell` seconds.
  virtual void setJaw(double opening, double dwell) = 0;
  /// A picture of the field as it is now.
  virtual FieldPicture look() = 0;
  /// The tool stays for a while [s].
  virtual void wait(double duration) = 0;
  /// How far the tool may be from the pose that was asked for last, one standard deviation of its
  /// position as the correction predicts it [m]; 0 if nobody predicts it.
  virtual double predictedDeviation() = 0;
  /// Measures how far the tool at rest is from the pose that was asked for last, and undoes it.
  /// @return false: it could not be measured
  virtual bool replanHere() = 0;
};

struct DebridementTaskConfig {
  Pose X_base_field;  ///< origin on the platform, z up
  Pose X_base_rest;   ///< over the receptacle: where fragments are let go
  /// Of the tool over the field; x points down, y is the direction in which the jaw closes.
  Eigen::Quaterniond orientation{0.5084, 0.4938, 0.4797, -0.5173};
  double turn_limit = 0.7;       ///< the tool is turned about the vertical by no more [rad]
  double round = 1.15;           ///< length / width below which a fragment has no direction [-]
  double hover = 0.025;          ///< above the fragment, before and after [m]
  double settle = 0.25;          ///< over and at the fragment, at rest [s]
  double jaw_open = 1.5708;      ///< as wide as it goes [rad]
  double jaw_closed = 0.0;       ///< [rad]
  double jaw_time = 0.45;        ///< for the jaw to open or to close [s]
  double waiting = 0.2;          ///< between two looks at what the other arm does [s]
  double retry_turn = 0.3;       ///< further attempts are turned by it, to and fro [rad]
  double retry_shift = 0.002;    ///< and go that much to either side, across the jaw [m]
  double deviation_limit = 0.0;  ///< replan where more is predicted, and after a miss [m]; 0: never
};

/// What was done about one fragment, from its choice to its end.
struct FragmentRecord {
  Eigen::Vector3d p_field = Eigen::Vector3d::Zero();  ///< where it was seen first [m]
  double begin = 0.0;                                 ///< [s]
  double end = 0.0;                                   ///< it was let go, or given up [s]
  unsigned attempts = 0;
  unsigned replans = 0;    ///< because of a large predicted deviation, or after a miss
  double predicted = 0.0;  ///< largest predicted deviation at an attempt [m]
  bool picked = false;     ///< the planner believes that it was picked up
};

class DebridementTask {
 public:
  /// @param arm  its number in `book`
  /// @throws InvalidInput  a time or a length that is negative
  DebridementTask(const DebridementTaskConfig& config, std::size_t arm, DebridementCell& cell,
                  FragmentBook& book);

  /// Clears the arm's part of the field; ends over the receptacle with the jaw open.
  /// @return in the order of the work
  std::vector<FragmentRecord> run();
  /// Where the tool goes for a fragment: to its centre, closing across its long axis, or, beyond
  /// turn_limit, as near to that as the limit allows. A robot that errs in the same way again would
  /// miss again, so further attempts are turned and shifted: by retry_turn and retry_shift, first
  /// towards the middle of what turn_limit allows, then the other way, then not at all, and so on.
  /// @param failed  attempts so far
  Pose graspPose(const FragmentSighting& fragment, unsigned failed = 0) const;
  double waited() const noexcept { return waited_; }  ///< for the other arm [s]

 private:
  std::optional<FragmentSighting> attempt(const FragmentSighting& fragment, FragmentRecord& record);
  void workOn(const FragmentBook::Choice& choice, FragmentRecord& record);

  DebridementTaskConfig config_;
  std::size_t arm_;
  DebridementCell& cell_;
  FragmentBook& book_;
  bool took_neighbour_ = false;
  double waited_ = 0.0;
};

/// The same motions to places where nothing lies, to be recorded and learnt from: over, down, up
/// and to the receptacle, `fragments` times.
/// @param half_size  the places are uniform in a box of these half sizes about `centre` [m], in the
///                   frame of the field
/// @param turn       the tool is turned about the vertical by up to so much, uniformly [rad]
/// @param tilt       and about each axis by this standard deviation, within two of them [rad]
struct RehearsalConfig {
  unsigned fragments = 60;
  Eigen::Vector3d centre{0.0, 0.0, 0.012};
  Eigen::Vector3d half_size{0.065, 0.065, 0.030};
  double turn = 1.1;
  double tilt = 0.1;
  double dwell = 0.3;  ///< at the end of each motion [s]
  std::uint64_t seed = 1;
};
/// @param isReachable  of the robot; places out of reach are drawn again
/// @param watch        called with the number of places that are done; may be empty
void rehearse(const DebridementTaskConfig& task, const RehearsalConfig& config,
              const std::function<bool(const Pose&)>& isReachable, DebridementCell& cell,
              const std::function<void(unsigned)>& watch);

}  // namespace raven_correction
