// SPDX-License-Identifier: BSD-3-Clause
// The corrector's callback as a whole, in this process: after the first message it allocates what
// roscpp allocates to publish the same two messages, and nothing more. The parts are
// test/ros/live_path_test.cpp and test/correction/corrector_test.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <mutex>

#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/corrector_node.h"
#include "raven_correction/ros/model_file.h"
#include "support/allocation_guard.h"
#include "support/node_main.h"
#include "support/raven_bytes.h"
#include "support/simple_model.h"
#include "support/temporary_directory.h"
#include "support/wait_for.h"

namespace raven_correction {
namespace {

constexpr int kMessages = 200;
const Pose kInside{{0.01, 0.01, -0.01}, expRotation({0.02, 0.0, 0.01})};
const char* const kLongFrame = "a_frame_whose_name_is_too_long_for_a_short_string";

/// What roscpp itself allocates to publish a command and `statuses` statuses to nobody.
template <typename Message>
int allocationsOfPublishing(bool command, int statuses) {
  ros::NodeHandle nh("bare");
  const ros::Publisher command_publisher = nh.advertise<Message>("servo_cp", 1);
  const ros::Publisher status_publisher = nh.advertise<CorrectionStatus>("status", 100);
  const auto message = boost::make_shared<Message>();
  const auto status = boost::make_shared<CorrectionStatus>();
  const auto publish = [&] {
    if (command) command_publisher.publish(message);
    for (int i = 0; i < statuses; ++i) status_publisher.publish(status);
  };
  publish();  // the first time, a place that may log makes itself known
  const AllocationGuard guard;
  publish();
  return guard.count();
}

/// A corrector in this process, fed through its callback.
template <typename Message>
class Fed {
 public:
  /// @param ns  of the node, with its parameters; all arms get simpleModel()
  Fed(const std::string& ns, const std::string& frame, const std::vector<std::string>& arms)
      : ns_(ns), node_(prepared(ns, frame, arms), ros::NodeHandle(ns + "/corrector")) {}

  /// Over a connection of its own, the same for all messages of a kind.
  ros::MessageEvent<Message const> event(const Message& message, bool latching = false) const {
    return {boost::make_shared<Message>(message), latching ? latching_ : plain_, ros::Time::now()};
  }

  /// Allocations within the callback, of messages that are made by `next`, after the first of them.
  template <typename Next>
  int count(Next next) {
    node_.onDesired(next());
    int allocations = 0;
    for (int i = 0; i < kMessages; ++i) {
      const ros::MessageEvent<Message const> event = next();
      const AllocationGuard guard;
      node_.onDesired(event);
      allocations += guard.count();
    }
    return allocations;
  }

  /// The status that answers a message, of the first arm.
  CorrectionStatus answer(const std::function<ros::MessageEvent<Message const>()>& next,
                          const std::string& arm) {
    ros::NodeHandle nh(ns_);
    std::mutex mutex;
    CorrectionStatus last;
    last.code = 255;
    const ros::Subscriber subscriber = nh.subscribe<CorrectionStatus>(
        arm + "correction/status", 100, [&](const CorrectionStatus::ConstPtr& status) {
          const std::lock_guard<std::mutex> lock(mutex);
          last = *status;
        });
    EXPECT_TRUE(waitFor(
        [&] {
          node_.onDesired(next());
          ros::spinOnce();
          const std::lock_guard<std::mutex> lock(mutex);
          return last.code != 255;
        },
        20.0));
    return last;
  }

 private:
  ros::NodeHandle prepared(const std::string& ns, const std::string& frame,
                           const std::vector<std::string>& arms) {
    Correction model = simpleModel();
    model.id = "an_id_of_a_model_that_is_as_long_as_those_of_the_trainer_20240131T120000Z_0123abcd";
    model.frame = frame;
    const ros::NodeHandle private_nh(ns + "/corrector");
    const auto give = [&](const std::string& arm, const std::string& parameter) {
      const std::string file = directory_.path() + "/" + arm + "_model.bag";
      model.arm = arm;
      writeModelFile(model, file, true);
      private_nh.setParam(parameter, file);
    };
    if (arms.empty()) give("", "model");
    for (const std::string& arm : arms) give("raven2_" + arm, arm + "/model");
    return ros::NodeHandle(ns);
  }

  static boost::shared_ptr<ros::M_string> connection(const std::string& latching) {
    const auto header = boost::make_shared<ros::M_string>();
    (*header)["callerid"] = "/planner_whose_name_is_too_long_for_a_short_string";
    (*header)["latching"] = latching;
    return header;
  }

  TemporaryDirectory directory_;
  const std::string ns_;
  const boost::shared_ptr<ros::M_string> plain_ = connection("0"), latching_ = connection("1");
  CorrectorNode node_;
};

TEST(CorrectorAllocation, OfACorrectedPoseIsThatOfPublishing) {
  using Message = geometry_msgs::PoseStamped;
  Fed<Message> corrector("one", kLongFrame, {});
  double angle = 0.0;
  const auto next = [&] {
    Message message;
    message.header.frame_id = kLongFrame;
    message.header.stamp = ros::Time::now();
    angle += 1e-3;
    message.pose =
        poseToMsg({{0.02 * std::sin(angle), 0.01, -0.01}, expRotation({0.02, 0.0, 0.0})});
    return message;
  };
  const auto corrected = [&] { return corrector.event(next()); };
  EXPECT_EQ(corrector.count(corrected), kMessages * allocationsOfPublishing<Message>(true, 1));

  const auto refused = [&] {
    Message message = next();
    message.pose.position.x = std::nan("");
    return corrector.event(message);
  };
  EXPECT_EQ(corrector.count(refused), kMessages * allocationsOfPublishing<Message>(false, 1));

  const auto latched = [&] { return corrector.event(next(), /*latching=*/true); };
  EXPECT_EQ(corrector.count(latched), kMessages * allocationsOfPublishing<Message>(true, 1));

  const CorrectionStatus answer = corrector.answer(corrected, "");
  EXPECT_LT(answer.code, CorrectionStatus::PASSED_OFF);  // they were corrected, not passed on
  EXPECT_GT((poseFromMsg(answer.command).p - poseFromMsg(answer.desired).p).norm(), 0.005);
}

TEST(CorrectorAllocation, OfACommandForBothArmsIsThatOfPublishing) {
  Fed<RavenCommand> corrector("two", "0_link", {"left", "right"});
  const auto next = [&] {
    RavenCommand message;
    message.bytes = command({"L", "R"});
    const ros::Time now = ros::Time::now();
    const std::uint32_t stamp[] = {now.sec, now.nsec};
    std::memcpy(message.bytes.data() + 4, stamp, sizeof stamp);  // after the sequence number
    RavenCommandContent content;
    EXPECT_TRUE(readRavenCommand(message.bytes, content));
    for (std::size_t i = 0; i < content.arm_count; ++i)
      writeRavenPose(message.bytes, content.arms[i].place, kInside, true, true);
    return corrector.event(message);
  };
  EXPECT_EQ(corrector.count(next), kMessages * allocationsOfPublishing<RavenCommand>(true, 2));
  EXPECT_LT(corrector.answer(next, "left/").code, CorrectionStatus::PASSED_OFF);
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_corrector_allocation");
}
