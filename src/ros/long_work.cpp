// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/long_work.h"

#include <chrono>
#include <thread>

namespace raven_correction {
namespace {

constexpr double kPublishPeriod = 0.1;  // [s]
constexpr std::chrono::seconds kLongestStep{30};

}  // namespace

LongWork::LongWork(ros::NodeHandle& private_nh, std::string name, const std::string& ask)
    : name_(std::move(name)), publisher_(private_nh.advertise<WorkProgress>("progress", 10, true)) {
  publish(WorkProgress::IDLE, "", 0.0, "waiting for " + ask);
  cancel_service_ = private_nh.advertiseService("cancel", &LongWork::onCancel, this);
}

void LongWork::publish(std::uint8_t state, const std::string& phase, double fraction,
                       const std::string& message) {
  WorkProgress progress;
  progress.header.stamp = ros::Time::now();
  progress.state = state;
  progress.phase = phase;
  progress.fraction = fraction;
  progress.message = message;
  progress.time_left = -1.0;
  const double elapsed = seconds();
  if (state == WorkProgress::RUNNING && fraction > 0.05)
    progress.time_left = elapsed * (1.0 - fraction) / fraction;
  const std::lock_guard<std::mutex> lock(mutex_);
  phase_ = phase;
  published_ = ros::SteadyTime::now();
  publisher_.publish(progress);
}

void LongWork::report(const std::string& phase, double fraction) {
  if (!ros::ok()) throw WorkCancelled("the node is shutting down; nothing was changed");
  if (cancel_) throw WorkCancelled("cancelled; nothing was changed");
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (phase == phase_ && (ros::SteadyTime::now() - published_).toSec() < kPublishPeriod) return;
  }
  publish(WorkProgress::RUNNING, phase, fraction, "");
}

double LongWork::seconds() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return (ros::SteadyTime::now() - started_).toSec();
}

LongWork::Result LongWork::run(const std::function<std::string()>& work) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (busy_)
      return {false,
              name_ + " is running; see ~progress and call again when it has ended, or ~cancel it"};
    started_ = ros::SteadyTime::now();
    busy_ = true;
    ++run_;
    cancelled_ = false;
    cancel_ = false;
  }
  Result result;
  bool cancelled = false;
  std::thread worker([&] {
    try {
      result.message = work();
      result.success = true;
    } catch (const WorkCancelled& reason) {
      cancelled = true;
      result.message = reason.what();
    } catch (const std::exception& error) {
      result.message = error.what();
    }
  });
  worker.join();
  publish(result.success ? WorkProgress::SUCCEEDED : WorkProgress::FAILED, "", 1.0, result.message);
  const std::lock_guard<std::mutex> lock(mutex_);
  busy_ = false;
  cancelled_ = cancelled;
  ended_.notify_all();
  return result;
}

bool LongWork::onCancel(std_srvs::Trigger::Request& /*request*/,
                        std_srvs::Trigger::Response& response) {
  std::unique_lock<std::mutex> lock(mutex_);
  if (!busy_) {
    response.message = "nothing is running";
    return true;
  }
  cancel_ = true;
  const std::uint64_t mine = run_;  // the next piece may begin before this thread wakes
  if (!ended_.wait_for(lock, kLongestStep, [&] { return run_ != mine || !busy_; })) {
    response.message =
        "asked; " + name_ + " has not come to the end of its step yet, see ~progress";
    return true;
  }
  if (run_ != mine) {
    response.message = name_ + " has ended, and another one runs; see ~progress";
    return true;
  }
  response.success = cancelled_;
  response.message = cancelled_ ? name_ + " was cancelled; nothing was changed"
                                : name_ + " had ended by then; see ~progress";
  return true;
}

}  // namespace raven_correction
