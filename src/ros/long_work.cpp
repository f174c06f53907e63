// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/long_work.h"

#include <thread>

namespace raven_correction {

LongWork::LongWork(ros::NodeHandle& private_nh, std::string name, const std::string& ask)
    : name_(std::move(name)), publisher_(private_nh.advertise<WorkProgress>("progress", 10, true)) {
  publish(WorkProgress::IDLE, "", 0.0, "waiting for " + ask);
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
  publisher_.publish(progress);
}

void LongWork::report(const std::string& phase, double fraction) {
  if (!ros::ok()) throw WorkCancelled();
  publish(WorkProgress::RUNNING, phase, fraction, "");
}

double LongWork::seconds() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return (ros::SteadyTime::now() - started_).toSec();
}

LongWork::Result LongWork::run(const std::function<std::string()>& work) {
  const std::unique_lock<std::mutex> running(running_, std::try_to_lock);
  if (!running.owns_lock())
    return {false, name_ + " is running; see ~progress and call again when it has ended"};
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    started_ = ros::SteadyTime::now();
  }
  Result result;
  std::thread worker([&] {
    try {
      result.message = work();
      result.success = true;
    } catch (const std::exception& error) {
      result.message = error.what();
    }
  });
  worker.join();
  publish(result.success ? WorkProgress::SUCCEEDED : WorkProgress::FAILED, "", 1.0, result.message);
  return result;
}

}  // namespace raven_correction
