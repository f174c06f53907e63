// SPDX-License-Identifier: BSD-3-Clause
// A service that takes its time, while the test goes on playing the robot.
#pragma once

#include <gtest/gtest.h>
#include <ros/ros.h>

#include <chrono>
#include <future>
#include <string>

namespace raven_correction {

/// Whether the answer is there.
template <typename Answer>
bool isReady(const std::future<Answer>& answer) {
  return answer.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

/// Calls in another thread. Of thousands of calls roscpp lost one, on a busy machine: it is made
/// again.
template <typename Service>
std::future<typename Service::Response> beginCall(const ros::NodeHandle& nh,
                                                  const std::string& name, const Service& request) {
  return std::async(std::launch::async, [resolved = nh.resolveName(name), request] {
    Service service = request;
    EXPECT_TRUE(ros::service::call(resolved, service) || ros::service::call(resolved, service))
        << resolved;
    return service.response;
  });
}

/// @param run  plays the robot until its argument, a condition, holds; false: it never did
template <typename Service, typename Run>
typename Service::Response callMeanwhile(const ros::NodeHandle& nh, const std::string& name,
                                         const Service& request, Run run) {
  auto answer = beginCall(nh, name, request);
  EXPECT_TRUE(run([&] { return isReady(answer); })) << name;
  return answer.get();
}

}  // namespace raven_correction
