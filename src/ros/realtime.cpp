// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/realtime.h"

#include <pthread.h>
#include <ros/poll_manager.h>
#include <sched.h>

#include <atomic>
#include <boost/make_shared.hpp>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <future>
#include <memory>
#include <utility>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr std::chrono::seconds kPatience{2};  ///< of a loop that turns ten times a second

class Action : public ros::CallbackInterface {
 public:
  explicit Action(std::function<void()> action) : action_(std::move(action)) {}
  CallResult call() override {
    action_();
    return Success;
  }

 private:
  const std::function<void()> action_;
};

}  // namespace

std::string takeRealtimePriority(int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int error =
      pthread_setschedparam(pthread_self(), SCHED_FIFO | SCHED_RESET_ON_FORK, &parameters);
  if (error == 0) return "";
  return format("no real-time priority %d: %s%s", priority, std::strerror(error),
                error == EPERM
                    ? "; the limit rtprio of the user, or the capability SYS_NICE of the "
                      "container, allows it (README, Troubleshooting)"
                    : "");
}

std::string giveSocketsRealtimePriority(int priority) {
  // The thread calls its listeners at every turn of its loop.
  const auto answer = std::make_shared<std::promise<std::string>>();
  const auto asked = std::make_shared<std::atomic<bool>>(false);
  const ros::PollManagerPtr& sockets = ros::PollManager::instance();
  std::future<std::string> refusal = answer->get_future();
  const boost::signals2::connection listener =
      sockets->addPollThreadListener([priority, answer, asked] {
        if (!asked->exchange(true)) answer->set_value(takeRealtimePriority(priority));
      });
  refusal.wait_for(kPatience);
  sockets->removePollThreadListener(listener);  // after this it is not called any more
  if (refusal.wait_for(std::chrono::seconds(0)) == std::future_status::ready) return refusal.get();
  return format(
      "no real-time priority %d for the sockets: their thread has not answered; is it busy, or "
      "has ros::start() not been called?",
      priority);
}

void doFirst(ros::CallbackQueueInterface& queue, std::function<void()> action) {
  queue.addCallback(boost::make_shared<Action>(std::move(action)));
}

}  // namespace raven_correction
