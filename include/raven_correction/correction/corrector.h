// SPDX-License-Identifier: BSD-3-Clause
// The live path: one desired pose in, one command out, or a reason why not. A safety device: it
// limits size and step of the correction, fades, blends models and modes, and never invents a
// command. F itself is predictor.h; topics, clocks and other publishers are the node's business.
#pragma once

#include <atomic>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "raven_correction/correction/corrector_code.h"
#include "raven_correction/correction/motion.h"
#include "raven_correction/correction/predictor.h"
#include "raven_correction/correction/robot_limits.h"

namespace raven_correction {

struct CorrectorLimits {
  double max_translation = 0.06;       ///< longest correction, > 0 [m]
  double max_rotation = 0.8;           ///< largest correction, > 0 [rad]
  double max_translation_rate = 0.15;  ///< of the correction itself, > 0 [m/s]
  double max_rotation_rate = 2.0;      ///< of the correction itself, > 0 [rad/s]
  double max_step_time = 0.1;  ///< a longer silence allows no larger step than this one, > 0 [s]
  double max_age = 0.5;        ///< of a desired pose when it arrives; 0 is not checked [s]
  double max_ahead = 0.5;      ///< of its stamp before the clock; 0 is not checked [s]
  /// A correction does not take the command out of this box, nor further out than the desired pose
  /// is; all zero: no box. [m]
  Eigen::Vector3d box_min = Eigen::Vector3d::Zero();
  Eigen::Vector3d box_max = Eigen::Vector3d::Zero();
  RobotLimits robot;  ///< what the native controller takes
  /// A pose of the tool whose stamp is further from the clock is not used, > 0 [s]
  double max_measured_age = 0.1;
};

/// Where the planner says that the tool will be.
struct Lookahead {
  double stamp = 0.0;  ///< after that of the desired pose [s]
  Pose pose;           ///< in the base frame
};

struct CorrectorOutput {
  CorrectorCode code = CorrectorCode::kRefusedNotFinite;
  CorrectorMode mode = CorrectorMode::kOff;  ///< in which it was answered
  double gain = 1.0;                         ///< share of the correction that was asked for [-]
  Pose command;                              ///< valid unless refused
  Eigen::Vector3d sd_position = Eigen::Vector3d::Zero();  ///< see Prediction [m]
  Eigen::Vector3d sd_rotation = Eigen::Vector3d::Zero();  ///< see Prediction [rad]
  double h_share = 0.0;     ///< share of H in what the model says, before gain and limits
  std::uint8_t limits = 0;  ///< bits of CorrectorLimit
  double distance = 0.0;    ///< of the desired pose from the box of the training poses [m]
  const std::string* model = nullptr;  ///< id of the model used, or null
  ToolKnownBy tool_known_by = ToolKnownBy::kNotAsked;
  bool ahead = false;  ///< the correction is that of the pose ahead
};

/// One corrector serves one stream of desired poses from one thread; setModel() and setMode()
/// may come from one other thread. Models are kept until the corrector ends: they are
/// a few megabytes and come a few times a day, and so the live path never frees one.
class Corrector {
 public:
  /// @throws InvalidInput  a limit out of its range
  explicit Corrector(const CorrectorLimits& limits);

  /// Takes effect with the next pose; the limit on the rate of the correction is the blend. It
  /// knows the motion so far. Nothing happens if the model in use has the same id: trainers that
  /// start again repeat themselves.
  /// @throws InvalidInput  see Predictor
  void setModel(const Correction& model);
  void setMode(CorrectorMode mode) noexcept { mode_.store(mode, std::memory_order_relaxed); }
  CorrectorMode mode() const noexcept { return mode_.load(std::memory_order_relaxed); }
  /// Takes the correction back, at its limited rate, for as long as there is a reason, also while
  /// the planner is silent: a pose that comes after a silence finds it as if poses had gone on
  /// coming.
  void setHold(CorrectionHold hold) noexcept {
    hold_.store(hold);
    if (hold != CorrectionHold::kNone) held_.store(true);
  }
  CorrectionHold hold() const noexcept { return hold_.load(std::memory_order_relaxed); }
  /// Takes effect with the next pose, at the limited rate.
  /// @param gain  share of the correction that is applied, 0 to 1 [-]
  /// @param max_translation, max_rotation  see CorrectorLimits
  /// @throws InvalidInput  out of range
  void setTuning(double gain, double max_translation, double max_rotation);

  /// Where the tool is by its encoders, in the base frame, for robot.max_step and robot.max_turn.
  /// Of the live thread. Ignored unless it is a pose with a stamp that is newer than the last one,
  /// not 0 (CRTK: not valid) and not ahead of the clock by more than max_measured_age.
  /// @param stamp  when it was there [s]
  /// @param now    the clock [s]
  void setMeasured(double stamp, double now, const Pose& measured) noexcept;

  /// The code with which correct() would refuse the pose for what it is, not counting
  /// kRefusedUnreachable; nothing if it would not. Changes no state.
  /// @param stamp, now, desired  as for correct()
  std::optional<CorrectorCode> fault(double stamp, double now, const Pose& desired) const noexcept;

  /// No allocation, lock, log or throw. With T the correction as a motion of the tool (translation
  /// in base, rotation vector in the tool frame), F(x) = x + T:
  ///   1. refuse what is not a pose, not new, or not of now: fault()
  ///   2. T from the mode: 0 (off), G, or F with its fades; times the gain
  ///   3. shorten T to max_translation and max_rotation, then to the longest share of it with which
  ///      the joints reach the command
  ///   4. move the T in force towards it by at most rate * time since the last pose
  ///   5. shorten the T in force so that the command is within robot.max_step and robot.max_turn of
  ///      the tool (or of the last command, where the tool is not known), and in the box; or no
  ///      further out than the desired pose is
  ///   6. refuse what the joints do not reach even so. T goes on changing pose by pose: where they
  ///      do not reach the desired pose either it is taken back, and then that pose passes
  /// A refused pose changes no state, except in step 6. Unless the code is kCorrected*, kRigidOnly
  /// or kPassedOutside, and once a former correction has been taken back in steps, the command
  /// equals the desired pose bit for bit.
  /// @param stamp    of the desired pose [s]
  /// @param now      the clock [s]
  /// @param desired  in the base frame
  /// @param endpoint  the pose is the first or last of a path (counts in mode endpoint only)
  /// @param ahead  where the tool is to be after modelDelay(), or null. Then step 2 is T = F(x') -
  /// x of
  ///        that pose x', with its motion: the tool is there when it should be. Not in mode
  ///        endpoint, and not where x' is outside the workspace of the model.
  CorrectorOutput correct(double stamp, double now, const Pose& desired, bool endpoint,
                          const Lookahead* ahead = nullptr) noexcept {
    const CorrectorOutput output = prepare(stamp, now, desired, endpoint, ahead);
    commit();
    return output;
  }
  /// What correct() would answer; nothing of it counts unless commit() follows. For a message that
  /// moves several arms and is sent whole or not at all.
  CorrectorOutput prepare(double stamp, double now, const Pose& desired, bool endpoint,
                          const Lookahead* ahead = nullptr) noexcept;
  /// The command of the last prepare() was sent; or it was kRefusedUnreachable, and the correction
  /// is taken back by a step. Nothing happens after any other refusal.
  void commit() noexcept;
  /// A command that cannot be corrected, since of position and orientation one is an increment or
  /// is not known. Of a part that is absolute, the correction in force is taken back at its limited
  /// rate; until then the command holds the rest of it. An increment is never changed, nor the
  /// correction of that part: the controller adds the one to what holds the other. Faults are the
  /// caller's business; like prepare(), it counts with commit().
  /// @param desired  what is not absolute may hold anything, and is in the command as it is
  /// @param position, orientation  this part is absolute
  CorrectorOutput prepareParts(double stamp, double now, const Pose& desired, bool position,
                               bool orientation) noexcept;

  /// Of the model in use: how far the tool is behind the commands; nothing without a model. Of the
  /// live thread. [s]
  std::optional<double> modelDelay() const noexcept;

  /// Forgets the stream (after a jump of the clock); the correction in force goes on from where it
  /// is.
  void restart() noexcept;

 private:
  struct Live {
    explicit Live(const Correction& model)
        : predictor(model),
          workspace(predictor.makeWorkspace()),
          estimator(model.motion),
          ahead(model.motion) {}
    Predictor predictor;
    std::shared_ptr<Predictor::Workspace> workspace;
    MotionEstimator estimator;
    MotionEstimator ahead;  ///< of the motion that is announced
  };

  CorrectorOutput answer() const noexcept;
  void aim(Live* live, const Pose& desired, bool endpoint, const Motion* ahead, Pose& wanted,
           CorrectorOutput& output) noexcept;

  void discard() noexcept;
  void follow(MotionEstimator& follower, double stamp, const Pose& desired) noexcept;
  const Motion* followAhead(Live* live, const Lookahead* ahead) noexcept;
  void takeBackAfterHold(double stamp) noexcept;
  double stepTime(double stamp) const noexcept;
  void keepWithinLimits(double now, Pose desired, bool position, bool orientation,
                        CorrectorOutput& output) noexcept;

  CorrectorLimits limits_;
  bool has_box_ = false;
  RobotReach reach_;
  std::atomic<CorrectorMode> mode_{CorrectorMode::kOff};
  std::atomic<CorrectionHold> hold_{CorrectionHold::kNone};
  std::atomic<bool> held_{false};  // there was a hold since the last pose
  std::atomic<double> gain_{1.0}, max_translation_, max_rotation_;
  std::vector<std::unique_ptr<Live>> models_;  // of the thread that sets models
  std::atomic<Live*> live_{nullptr};

  /// What poses change.
  struct Stream {
    bool started = false;
    double last_stamp = 0.0;
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();  ///< correction in force, base frame
    Eigen::Vector3d rotation = Eigen::Vector3d::Zero();     ///< rotation vector, tool frame
    Pose last_command;
    bool commanded = false;            ///< last_command is one
    MotionEstimator* ahead = nullptr;  ///< has followed the announced motion up to here
  };

  // Of the live thread.
  Stream stream_;                                // of the poses that count
  Stream next_;                                  // after commit()
  bool prepared_ = false;                        // next_ is valid
  bool held_seen_ = false;                       // by next_
  MotionEstimator* followed_ = nullptr;          // has the pose of next_, too; null: none has
  MotionEstimator* followed_ahead_ = nullptr;    // has the pose ahead of it, too; null: none has
  MotionEstimator before_models_;                // follows the motion until there is a model
  MotionEstimator* follower_ = &before_models_;  // who follows it now
  Pose measured_;
  double measured_at_ = -std::numeric_limits<double>::infinity();
};

}  // namespace raven_correction
