// SPDX-License-Identifier: BSD-3-Clause
// A corrector seen from outside, through its real topics and services: sends poses, keeps what
// comes back. For PoseStamped and TransformStamped.
#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <std_srvs/SetBool.h>

#include <algorithm>
#include <string>
#include <vector>

#include "raven_correction/CorrectionModel.h"
#include "raven_correction/CorrectionStatus.h"
#include "raven_correction/SetMode.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/model_file.h"
#include "support/spin_until.h"

namespace raven_correction {

inline void setPose(geometry_msgs::PoseStamped& message, const Pose& pose) {
  message.pose = poseToMsg(pose);
}
inline void setPose(geometry_msgs::TransformStamped& message, const Pose& pose) {
  message.transform = transformToMsg(pose);
}

template <typename Message>
class CorrectorProbe {
 public:
  static constexpr double kLimit = 20.0;  ///< for what takes milliseconds on an idle machine [s]

  /// @param ns  namespace of the corrector
  explicit CorrectorProbe(const std::string& ns) : nh(ns) {
    publisher = nh.advertise<Message>("desired/servo_cp", 100);
    model_publisher_ = nh.advertise<CorrectionModel>("correction/model", 1, true);
    command_subscriber_ = nh.subscribe<Message>(
        "servo_cp", 1000, [this](const auto& message) { commands.push_back(*message); });
    status_subscriber_ = nh.subscribe<CorrectionStatus>(
        "correction/status", 10000, [this](const auto& message) { statuses.push_back(*message); });
    diagnostics_subscriber_ = nh.subscribe<diagnostic_msgs::DiagnosticArray>(
        "/diagnostics", 100, [this](const auto& message) {
          for (const auto& status : message->status)
            if (status.name.find(nh.resolveName("corrector").substr(1)) == 0 ||
                status.name.find(nh.resolveName("corrector")) == 0)
              diagnostics.push_back(status);
        });
    EXPECT_TRUE(ros::service::waitForService(nh.resolveName("corrector/enable"), 30000));
    EXPECT_TRUE(until([this] {
      return publisher.getNumSubscribers() == 1 && command_subscriber_.getNumPublishers() >= 1 &&
             status_subscriber_.getNumPublishers() == 1 &&
             model_publisher_.getNumSubscribers() == 1;
    }));
  }

  template <typename Condition>
  bool until(Condition condition, double limit = kLimit) {
    return spinUntil(condition, limit);
  }

  Message message(const Pose& pose, const std::string& frame = "0_link") const {
    Message message;
    message.header.stamp = ros::Time::now();
    message.header.frame_id = frame;
    setPose(message, pose);
    return message;
  }

  /// Sends one message and returns the status that answers it.
  CorrectionStatus send(const Message& message) {
    const std::size_t before = statuses.size();
    publisher.publish(message);
    EXPECT_TRUE(until([&] { return statuses.size() > before; }));
    return statuses.empty() ? CorrectionStatus() : statuses.back();
  }
  CorrectionStatus send(const Pose& pose) { return send(message(pose)); }
  /// Sends a pose again and again until a status satisfies the condition.
  template <typename Condition>
  bool sendUntil(const Pose& pose, Condition condition, const std::string& frame = "0_link") {
    return until([&] { return condition(send(message(pose, frame))); });
  }

  /// Fails the test unless the message is refused with this code and nothing is forwarded.
  /// @param good  a pose that is forwarded
  void expectRefused(const Message& bad, std::uint8_t code, const Pose& good,
                     const std::string& frame = "0_link") {
    // What was forwarded before may be on its way still, on a connection of its own.
    const auto accepted = std::find_if(statuses.rbegin(), statuses.rend(),
                                       [](const auto& status) { return status.code < 16; });
    if (accepted != statuses.rend()) {
      const ros::Time stamp = accepted->header.stamp;
      EXPECT_TRUE(
          until([&] { return !commands.empty() && commands.back().header.stamp >= stamp; }));
    }
    const std::size_t before = commands.size();
    EXPECT_EQ(send(bad).code, code);
    // Each topic is one connection, in order: after a further accepted pose exactly one command
    // more has arrived.
    EXPECT_LT(send(message(good, frame)).code, 16);
    EXPECT_TRUE(until([&] { return commands.size() > before; }));
    EXPECT_EQ(commands.size(), before + 1);
  }

  void publishModel(const CorrectionModel& model) { model_publisher_.publish(model); }
  void publishModel(const Correction& model) { publishModel(modelToMsg(model)); }

  void setMode(const std::string& mode) {
    SetMode call;
    call.request.mode = mode;
    // Of thousands of calls roscpp lost one, on a busy machine; what is asked is what is answered.
    EXPECT_TRUE(
        until([&] { return ros::service::call(nh.resolveName("corrector/set_mode"), call); }));
    EXPECT_TRUE(call.response.success) << call.response.message;
  }

  /// Waits for diagnostics that come after this call and whose text satisfies the condition.
  template <typename Condition>
  bool diagnosed(Condition condition) {
    diagnostics.clear();
    return until([&] {
      for (const auto& status : diagnostics)
        if (condition(status)) return true;
      diagnostics.clear();
      return false;
    });
  }

  ros::NodeHandle nh;
  ros::Publisher publisher;
  std::vector<Message> commands;
  std::vector<CorrectionStatus> statuses;
  std::vector<diagnostic_msgs::DiagnosticStatus> diagnostics;

 private:
  ros::Publisher model_publisher_;
  ros::Subscriber command_subscriber_, status_subscriber_, diagnostics_subscriber_;
};

/// Fails the test where the command moved further than the desired pose did by itself plus what the
/// limit on the rate of the correction allows, between any two of the poses that were forwarded.
inline void expectStepsWithin(const std::vector<CorrectionStatus>& statuses,
                              double translation_rate, double rotation_rate, double max_step_time) {
  constexpr double kStampResolution = 1e-7;  // a time of today as a double is good to 0.2 us
  const CorrectionStatus* last = nullptr;
  for (const CorrectionStatus& now : statuses) {
    if (now.code >= 16) continue;
    if (last != nullptr) {
      const double elapsed =
          std::min((now.header.stamp - last->header.stamp).toSec(), max_step_time);
      const Pose a = poseFromMsg(last->command), b = poseFromMsg(now.command);
      const Pose own_a = poseFromMsg(last->desired), own_b = poseFromMsg(now.desired);
      EXPECT_LE((b.p - a.p).norm(),
                (own_b.p - own_a.p).norm() + translation_rate * elapsed + kStampResolution)
          << "at " << now.header.stamp;
      EXPECT_LE(rotationAngle(a.q, b.q),
                rotationAngle(own_a.q, own_b.q) + rotation_rate * elapsed + 1e-6)
          << "at " << now.header.stamp;
    }
    last = &now;
  }
}

}  // namespace raven_correction
