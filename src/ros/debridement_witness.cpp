// SPDX-License-Identifier: BSD-3-Clause
#include "debridement_witness.h"

#include <std_msgs/Float64.h>

#include <algorithm>
#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/ros/topics.h"

namespace raven_correction {

DebridementWitness::DebridementWitness(const std::vector<std::string>& arms,
                                       const std::string& camera, const std::string& simulator,
                                       const std::string& file)
    : table_(file) {
  table_ << "condition,scene,stamp,gripper,outcome,fragment,along_mm,across_mm,pads_mm,extent_mm,"
            "tilt_deg\n";
  ros::NodeHandle nh;
  subscribers_.push_back(nh.subscribe<GraspResult>(
      camera + "/grasps", 100, [this](const GraspResultConstPtr& message) { onGrasp(*message); }));
  subscribers_.push_back(nh.subscribe<std_msgs::Float64>(
      simulator + "/clearance", 100, [this](const std_msgs::Float64ConstPtr& message) {
        const std::lock_guard<std::mutex> lock(mutex_);
        clearance_ = std::min(clearance_, message->data);
      }));
  for (const std::string& arm : arms)
    subscribers_.push_back(nh.subscribe<CorrectionStatus>(
        arm + "/" + topics::kStatus, 1000,
        [this](const CorrectionStatusConstPtr& message) { onStatus(*message); }));
}

void DebridementWitness::begin(const std::string& condition) {
  const std::lock_guard<std::mutex> lock(mutex_);
  condition_ = condition;
  clearance_ = std::numeric_limits<double>::infinity();
  poses_ = {};
}

void DebridementWitness::begin(std::uint64_t scene) {
  const std::lock_guard<std::mutex> lock(mutex_);
  scene_ = scene;
  counts_.fill(0);
}

unsigned DebridementWitness::count(std::uint8_t outcome) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return counts_.at(outcome);
}

double DebridementWitness::clearance() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return clearance_;
}

CorrectedPoses DebridementWitness::poses() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return poses_;
}

void DebridementWitness::onStatus(const CorrectionStatus& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++poses_.all;
  if (status.code > CorrectionStatus::RIGID_ONLY) return;
  ++poses_.corrected;
  if (status.code != CorrectionStatus::CORRECTED) ++poses_.reduced;
}

void DebridementWitness::onGrasp(const GraspResult& message) {
  static const char* const names[] = {"held", "missed", "delivered", "dropped", "lost", "empty"};
  const std::lock_guard<std::mutex> lock(mutex_);
  if (message.outcome >= counts_.size()) return;
  ++counts_[message.outcome];
  table_ << condition_ << ',' << scene_ << ','
         << format("%.3f,%s,%s,%d,%.2f,%.2f,%.2f,%.2f,%.1f\n", message.header.stamp.toSec(),
                   message.gripper.c_str(), names[message.outcome], message.fragment,
                   1e3 * message.offset.x, 1e3 * message.offset.y, 1e3 * message.offset.z,
                   1e3 * message.extent, message.tilt * 180.0 / M_PI)
         << std::flush;
}

}  // namespace raven_correction
