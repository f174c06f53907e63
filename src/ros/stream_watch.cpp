// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/stream_watch.h"

#include "raven_correction/ros/master_watch.h"

namespace raven_correction {
namespace {

constexpr double kPeriod = 3.0;  // between looks [s]

}  // namespace

StreamWatch::StreamWatch(const StreamCheckOptions& options, std::vector<TopicType> expected)
    : expected_(std::move(expected)), check_(options), spinner_(1, &queue_) {
  ros::NodeHandle nh;
  nh.setCallbackQueue(&queue_);
  timer_ = nh.createWallTimer(ros::WallDuration(kPeriod),
                              [this](const ros::WallTimerEvent&) { look(); });
  spinner_.start();
}

StreamWatch::~StreamWatch() { spinner_.stop(); }

void StreamWatch::addPose(StreamRole role, double stamp, double arrival, const std::string& frame,
                          const Pose& pose, const Pose* X_base_frame) {
  const std::lock_guard<std::mutex> lock(mutex_);
  check_.addPose(role, stamp, arrival, frame, pose, X_base_frame);
  ++samples_;
}

void StreamWatch::addJoints(double stamp, double arrival, const std::vector<std::string>& names,
                            const std::vector<double>& positions) {
  const Eigen::VectorXd values = Eigen::Map<const Eigen::VectorXd>(
      positions.data(), static_cast<Eigen::Index>(positions.size()));
  const std::lock_guard<std::mutex> lock(mutex_);
  check_.addJoints(stamp, arrival, names, values);
  ++samples_;
}

void StreamWatch::clear() {
  const std::lock_guard<std::mutex> lock(mutex_);
  check_.clear();
  ++clearings_;
  of_streams_.clear();
}

std::vector<StreamFinding> StreamWatch::findings() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<StreamFinding> all = of_topics_;
  all.insert(all.end(), of_streams_.begin(), of_streams_.end());
  return all;
}

void StreamWatch::look() {
  std::vector<TopicType> published;
  if (askTopics(published)) {
    std::vector<StreamFinding> of_topics = checkTopics(expected_, published);
    const std::lock_guard<std::mutex> lock(mutex_);
    of_topics_ = std::move(of_topics);
  }
  std::unique_lock<std::mutex> lock(mutex_);
  if (samples_ == looked_at_) return;  // nothing new
  looked_at_ = samples_;
  const StreamCheck check = check_;
  const std::size_t clearings = clearings_;
  lock.unlock();
  std::vector<StreamFinding> of_streams = check.allFindings();
  lock.lock();
  if (clearings == clearings_) of_streams_ = std::move(of_streams);
}

}  // namespace raven_correction
