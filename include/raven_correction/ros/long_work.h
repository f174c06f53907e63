// SPDX-License-Identifier: BSD-3-Clause
// Work of minutes behind a service: one piece at a time, in a thread of its own, with ~progress
// (latched) meanwhile, and an end when the node shuts down. What the work is, is the node's.
#pragma once

#include <raven_correction/WorkProgress.h>
#include <ros/ros.h>

#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>

namespace raven_correction {

/// Thrown through the work by LongWork::report() when the node is shutting down.
struct WorkCancelled : std::runtime_error {
  WorkCancelled() : std::runtime_error("the node is shutting down; nothing was changed") {}
};

/// Services are called from several threads (AsyncSpinner), and so may be run().
class LongWork {
 public:
  /// @param name  for messages: "a training"
  /// @param ask   service that starts it, for the first message: "~retrain"
  LongWork(ros::NodeHandle& private_nh, std::string name, const std::string& ask);

  struct Result {
    bool success = false;
    std::string message;  ///< of the work, or of the exception that ended it
  };
  /// Calls `work` in a thread of its own, so that nothing it does (stack, thread pools) touches the
  /// spinner's, and returns when it has ended. While one piece runs another is refused, and says
  /// so.
  /// @param work  returns its message of success; an exception is a failure
  Result run(const std::function<std::string()>& work);

  /// To be called by the work, from any thread of it. Publishes with an estimate of the time left.
  /// @param fraction  of the whole, 0 to 1
  /// @throws WorkCancelled  the node is shutting down
  void report(const std::string& phase, double fraction);

  /// Since the piece that runs, or ran last, began [s].
  double seconds() const;

 private:
  void publish(std::uint8_t state, const std::string& phase, double fraction,
               const std::string& message);

  std::string name_;
  std::mutex running_;  // held while a piece runs

  // Guarded by mutex_.
  mutable std::mutex mutex_;
  ros::SteadyTime started_;
  ros::Publisher publisher_;
};

}  // namespace raven_correction
