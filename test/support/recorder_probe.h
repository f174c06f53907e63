// SPDX-License-Identifier: BSD-3-Clause
// A recorder seen from outside, through its real topics and services: starts and stops it, counts
// what it has received, reads what it wrote.
#pragma once

#include <gtest/gtest.h>
#include <ros/ros.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <string>
#include <vector>

#include "raven_correction/RecorderStatus.h"
#include "raven_correction/StartRecording.h"
#include "raven_correction/StopRecording.h"
#include "support/spin_until.h"

namespace raven_correction {

constexpr double kRecorderLimit = 15.0;  // for everything that takes milliseconds [s]

/// A recorder seen from outside: its status, its services.
class RecorderProbe {
 public:
  explicit RecorderProbe(const std::string& ns) : nh(ns) {
    status_subscriber_ =
        nh.subscribe<RecorderStatus>("recorder/status", 100, [this](const auto& message) {
          status_ = *message;
          ++statuses_;
        });
    EXPECT_TRUE(ros::service::waitForService(nh.resolveName("recorder/start"), 15000));
    EXPECT_TRUE(until([this] { return statuses_ > 0; }));
  }
  StartRecording::Response start(const std::string& bag) {
    StartRecording call;
    call.request.bag = bag;
    EXPECT_TRUE(ros::service::call(nh.resolveName("recorder/start"), call));
    // A status of the recording before counts the messages of that one.
    if (call.response.success) {
      EXPECT_TRUE(until([&] { return status_.bag == call.response.bag; })) << call.response.bag;
    }
    return call.response;
  }
  StopRecording::Response stop() {
    StopRecording call;
    EXPECT_TRUE(ros::service::call(nh.resolveName("recorder/stop"), call));
    return call.response;
  }
  /// Waits for a condition while messages arrive.
  template <typename Condition>
  bool until(Condition condition) {
    return spinUntil(condition, kRecorderLimit);
  }
  bool untilReceived(const std::string& topic, std::uint64_t count) {
    const auto reached = [&] { return received(topic) >= count; };
    return until(reached);
  }
  std::uint64_t received(const std::string& topic) const {
    for (std::size_t i = 0; i < status_.topics.size(); ++i)
      if (status_.topics[i] == nh.resolveName(topic)) return status_.messages[i];
    return 0;
  }
  const RecorderStatus& status() const { return status_; }
  template <typename Message>
  ros::Publisher advertise(const std::string& topic) {
    ros::Publisher publisher = nh.advertise<Message>(topic, 100000);
    EXPECT_TRUE(until([&] { return publisher.getNumSubscribers() > 0; })) << topic;
    return publisher;
  }

  ros::NodeHandle nh;

 private:
  RecorderStatus status_;
  int statuses_ = 0;
  ros::Subscriber status_subscriber_;
};

/// All messages of a topic, in the order of the bags.
template <typename Message>
std::vector<boost::shared_ptr<Message>> read(const std::vector<std::string>& bags,
                                             const std::string& topic) {
  std::vector<boost::shared_ptr<Message>> all;
  for (const std::string& path : bags) {
    rosbag::Bag bag(path, rosbag::bagmode::Read);
    rosbag::View view(bag, rosbag::TopicQuery(topic));
    for (const rosbag::MessageInstance& message : view)
      all.push_back(message.instantiate<Message>());
  }
  return all;
}

}  // namespace raven_correction
