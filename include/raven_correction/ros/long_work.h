// SPDX-License-Identifier: BSD-3-Clause
// Work of minutes behind a service: one piece at a time, in a thread of its own, with ~progress
// (latched) meanwhile, ~cancel, and an end when the node shuts down. What the work is, is the
// node's.
#pragma once

#include <raven_correction/WorkProgress.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>

namespace raven_correction {

/// Thrown through the work by LongWork::report() when it is to end.
struct WorkCancelled : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Services are called from several threads (AsyncSpinner), and so may be run(). One thread waits
/// for the work, another for the end of what ~cancel has cancelled: a node needs three.
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

  /// To be called by the work, from any thread of it, and for the last time before it changes
  /// anything that lasts. Publishes a new phase at once, and ten times a second how far it is, with
  /// an estimate of the time left.
  /// @param fraction  of the whole, 0 to 1
  /// @throws WorkCancelled  ~cancel was called, or the node is shutting down
  void report(const std::string& phase, double fraction);

  /// Since the piece that runs, or ran last, began [s].
  double seconds() const;

 private:
  bool onCancel(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  void publish(std::uint8_t state, const std::string& phase, double fraction,
               const std::string& message);

  const std::string name_;
  std::atomic<bool> cancel_{false};

  // Guarded by mutex_.
  mutable std::mutex mutex_;
  std::condition_variable ended_;
  bool busy_ = false;       // a piece runs
  std::uint64_t run_ = 0;   // pieces that were begun
  bool cancelled_ = false;  // the last piece
  std::string phase_;       // published last
  ros::SteadyTime started_, published_;
  ros::Publisher publisher_;
  // Declared last: its callback uses everything above.
  ros::ServiceServer cancel_service_;
};

}  // namespace raven_correction
