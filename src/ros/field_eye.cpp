// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/field_eye.h"

#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include <chrono>
#include <future>
#include <stdexcept>

#include "raven_correction/ros/topics.h"

namespace raven_correction {
namespace {

constexpr double kStampMargin = 0.05;  // by which the camera's clock message may be older [s]
constexpr int kPatience = 20;          // for camera and detector [s, real]

}  // namespace

FieldEye::FieldEye(const std::string& camera, const std::string& simulator)
    : take_picture_(camera + "/simulator/take_picture"), pause_(simulator + "/pause") {
  ros::NodeHandle nh(camera);
  subscriber_ = nh.subscribe<FragmentArray>(
      topics::kFragments, 5, [this](const FragmentArrayConstPtr& msg) { onFragments(*msg); });
}

void FieldEye::onFragments(const FragmentArray& message) {
  FieldPicture picture;
  picture.stamp = message.header.stamp.toSec();
  for (const Fragment& fragment : message.fragments)
    picture.fragments.push_back(
        {Eigen::Vector3d(fragment.position.x, fragment.position.y, fragment.position.z),
         fragment.yaw, fragment.length, fragment.width, fragment.partly_hidden != 0});
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (picture.stamp < newest_.stamp) return;
    newest_ = picture;
  }
  arrived_.notify_all();
}

void FieldEye::pause(bool stand) {
  const std::lock_guard<std::mutex> lock(pause_mutex_);
  standing_ += stand ? 1 : -1;
  if (standing_ != (stand ? 1 : 0)) return;  // somebody else waits, too
  std_srvs::SetBool call;
  call.request.data = stand;
  if (!ros::service::call(pause_, call) || !call.response.success)
    throw std::runtime_error(pause_ + ": " + call.response.message);
  const ros::SteadyTime now = ros::SteadyTime::now();
  if (stand)
    since_ = now;
  else
    stood_ += (now - since_).toSec();
}

FieldPicture FieldEye::look(const std::function<void()>& meanwhile) {
  const double earliest = ros::Time::now().toSec() - kStampMargin;
  auto taken = std::async(std::launch::async, [this] {
    std_srvs::Trigger call;
    return ros::service::call(take_picture_, call) && call.response.success;
  });
  meanwhile();
  const auto is_new = [&] { return newest_.stamp >= earliest; };
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    // The answer of the service may still be on its way, but the picture was taken.
    if (is_new()) return newest_;
  }
  pause(true);
  const bool answered = taken.get();
  bool found = false;
  FieldPicture picture;
  if (answered) {
    std::unique_lock<std::mutex> lock(mutex_);
    found = arrived_.wait_for(lock, std::chrono::seconds(kPatience), is_new);
    picture = newest_;
  }
  pause(false);
  if (!answered) throw std::runtime_error(take_picture_ + " did not answer");
  if (!found)
    throw std::runtime_error(subscriber_.getTopic() +
                             ": the detector does not answer to a picture");
  return picture;
}

double FieldEye::stood() {
  const std::lock_guard<std::mutex> lock(pause_mutex_);
  return stood_;
}

}  // namespace raven_correction
