// SPDX-License-Identifier: BSD-3-Clause
// What a corrector learns of its arm beside the live path: the poses that it was asked for and has
// sent, and, while a pre-flight runs, what motion capture saw. Their checks are
// dataset/stream_check.h, the judgement evaluation/preflight.h.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <ros/callback_queue_interface.h>
#include <ros/node_handle.h>

#include <array>
#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "raven_correction/dataset/stream_check.h"
#include "raven_correction/ros/corrector_params.h"
#include "raven_correction/ros/registration.h"

namespace raven_correction {

/// One desired pose and what was sent for it, as plain memory.
struct LiveSample {
  double stamp = 0.0;    ///< of the message [s]
  double arrival = 0.0;  ///< by the ROS clock [s]
  Pose desired;          ///< as received, perhaps not finite
  Pose command;          ///< where `sent`
  bool sent = false;
  std::array<char, 40> frame{};  ///< as sent, cut, zero at the end

  void setFrame(std::string_view name) noexcept {
    const std::size_t length = name.copy(frame.data(), frame.size() - 1);
    frame[length] = '\0';
  }
};

/// From one thread to one other, without lock; its memory is its own.
using LiveQueue = boost::lockfree::spsc_queue<LiveSample, boost::lockfree::capacity<4096>>;

class ArmObserver {
 public:
  /// @param nh           of the arm's topics
  /// @param check_queue  of threads that may wait
  ArmObserver(const ros::NodeHandle& nh, const CorrectorParams& params,
              ros::CallbackQueueInterface& check_queue);
  ~ArmObserver();

  /// Of the live thread: no allocation, lock or wait. What finds no room is left out.
  void note(const LiveSample& sample) noexcept { queue_.push(sample); }

  /// Moves of the arm, in base, by increasing stamp.
  struct Moves {
    PoseStream commands, observations;
    std::vector<StreamFinding> findings;
    double seconds = 0.0;  ///< for which they were observed [s]
    std::string problem;   ///< why there is nothing to judge; empty: there is
  };
  /// Listens to motion capture until there are enough observations of a commanded arm, or the time
  /// is over; waits. One at a time.
  /// @param duration  at most [s, steady clock]
  /// @param poses     observations that came within half a second of a command
  /// @param extent    of the commands: diagonal of the box about them [m]
  Moves observe(double duration, std::size_t poses, double extent);
  /// Ends observe(), for good.
  void stop();

  /// Of the desired poses that came lately.
  std::vector<StreamFinding> findings() const;
  std::string mocapTopic() const { return nh_.resolveName(mocap_topic_); }

 private:
  void drain();
  void onMocap(const geometry_msgs::PoseStampedConstPtr& message);
  bool enough(std::size_t poses, double extent) const;

  ros::NodeHandle nh_;  // with the queue of the checks
  const CorrectorParams params_;
  const std::string mocap_topic_;
  LiveQueue queue_;

  // Guarded by mutex_; the reading end of queue_ is, too.
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  StreamCheck desired_;
  std::vector<StreamFinding> findings_;
  ros::SteadyTime checked_at_;
  bool observing_ = false, stopping_ = false;
  StreamCheck moves_check_;
  PoseStream commands_, observations_;
  std::size_t commanded_ = 0;  // observations within reach of a command
  std::string frame_;          // of motion capture, as sent
  bool registered_ = false;    // the frame is known to tf
  std::unique_ptr<Registration> registration_;

  ros::WallTimer timer_;  // last: it uses all of the above
};

}  // namespace raven_correction
