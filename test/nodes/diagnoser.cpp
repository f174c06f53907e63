// SPDX-License-Identifier: BSD-3-Clause
// The diagnoser as a user asks it: a hidden effect is named by service, on the latched topic and in
// the files; bad requests change nothing; a second call is refused while one runs, which can be
// cancelled.
#include <XmlRpcClient.h>
#include <gtest/gtest.h>
#include <raven_correction/Diagnose.h>
#include <raven_correction/DiagnosisVerdict.h>
#include <raven_correction/WorkProgress.h>
#include <ros/network.h>
#include <ros/package.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <future>
#include <mutex>
#include <set>

#include "raven_correction/dataset/dataset_directory.h"
#include "raven_correction/ros/session_bag.h"
#include "raven_correction/simulation/session.h"
#include "simulation/simulations.h"
#include "support/node_main.h"
#include "support/wait_for.h"

namespace raven_correction {
namespace {

namespace fs = std::filesystem;

constexpr double kLimit = 60.0;       // for a diagnosis of seconds [s]
constexpr double kEndOfRound = 15.0;  // for the pass that is under way when it is shut down [s]
constexpr double kOffset = 0.05;      // hidden [rad]

std::string directory() {
  std::string path;
  ros::param::get("directory", path);
  return path;
}

/// Callbacks run in a spinner, so a call of ~diagnose may wait for its answer meanwhile.
class Diagnoser : public ::testing::Test {
 protected:
  Diagnoser() : nh_("arm"), spinner_(2) {
    progress_ = nh_.subscribe<WorkProgress>("diagnoser/progress", 100, [this](const auto& msg) {
      const std::lock_guard<std::mutex> lock(mutex_);
      states_.push_back(*msg);
    });
    verdict_ = nh_.subscribe<DiagnosisVerdict>("diagnoser/verdict", 10, [this](const auto& msg) {
      const std::lock_guard<std::mutex> lock(mutex_);
      verdicts_.push_back(*msg);
    });
    spinner_.start();
    EXPECT_TRUE(ros::service::waitForService(nh_.resolveName("diagnoser/diagnose"), 30000));
  }
  ~Diagnoser() override { spinner_.stop(); }

  Diagnose::Response call(const Diagnose::Request& request) {
    Diagnose service;
    service.request = request;
    EXPECT_TRUE(ros::service::call(nh_.resolveName("diagnoser/diagnose"), service));
    return service.response;
  }
  bool has(std::uint8_t state) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::any_of(states_.begin(), states_.end(),
                       [&](const WorkProgress& progress) { return progress.state == state; });
  }
  std::size_t verdicts() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return verdicts_.size();
  }

  ros::NodeHandle nh_;
  ros::AsyncSpinner spinner_;
  ros::Subscriber progress_, verdict_;
  std::mutex mutex_;
  std::vector<WorkProgress> states_;
  std::vector<DiagnosisVerdict> verdicts_;
};

TEST_F(Diagnoser, NamesWhatIsHiddenAndRefusesWhatIsBad) {
  EXPECT_TRUE(waitFor([&] { return has(WorkProgress::IDLE); }, kLimit));  // latched

  // Nothing there, a file that is none, a simulation that is none, options out of range.
  fs::create_directories(directory() + "/data");
  Diagnose::Request request;
  EXPECT_NE(call(request).message.find("no bag"), std::string::npos);
  request.inputs = {"nowhere.bag"};
  Diagnose::Response response = call(request);
  EXPECT_FALSE(response.success);
  EXPECT_NE(response.message.find("nowhere.bag"), std::string::npos) << response.message;

  SimulationConfig hidden = loadSimulationConfig(ros::package::getPath("raven_correction") +
                                                 "/config/simulation/nominal.yaml");
  hidden.set(effectWith("joint_offset", hidden.robot, {{"d[elbow]", kOffset}}));
  Dataset session = simulateSession(hidden, 12, 4);
  session.name = "hidden";
  writeSessionBag(session, directory() + "/data/session.bag");
  request.inputs = {"session.bag"};  // relative to the data directory
  request.driven_by = "wishes";
  EXPECT_NE(call(request).message.find("wishes"), std::string::npos);
  request.driven_by = "";
  request.folds = 1;
  EXPECT_NE(call(request).message.find("folds"), std::string::npos);
  request.folds = 4;
  request.simulation = directory() + "/nowhere.yaml";
  EXPECT_NE(call(request).message.find("nowhere.yaml"), std::string::npos);
  request.simulation = "";
  EXPECT_TRUE(waitFor([&] { return has(WorkProgress::FAILED); }, kLimit));
  EXPECT_EQ(verdicts(), 0u);
  EXPECT_FALSE(fs::exists(directory() + "/simulations") &&
               !fs::is_empty(directory() + "/simulations"));

  // The diagnosis, and a second call while it runs.
  request.max_samples = 400;
  request.max_causes = 2;
  request.output = "extended.yaml";
  request.json = "verdict.json";
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    states_.clear();
  }
  // Both at once, because one alone may have ended before a second call arrives.
  auto one = std::async(std::launch::async, [&] { return call(request); });
  auto other = std::async(std::launch::async, [&] { return call(request); });
  response = one.get();
  auto refused = other.get();
  if (!response.success) std::swap(response, refused);
  EXPECT_TRUE(has(WorkProgress::RUNNING));
  EXPECT_FALSE(refused.success);
  EXPECT_NE(refused.message.find("is running"), std::string::npos) << refused.message;

  ASSERT_TRUE(response.success) << response.message;
  ASSERT_FALSE(response.causes.empty());
  EXPECT_EQ(response.causes.front(), "joint_offset of elbow");
  EXPECT_GT(response.gain_percent, 80.0);
  EXPECT_LT(response.after_rms_mm, 0.2 * response.before_rms_mm);
  ASSERT_EQ(response.files.size(), 2u);
  for (const std::string& file : response.files) EXPECT_TRUE(fs::exists(file)) << file;
  EXPECT_TRUE(waitFor([&] { return has(WorkProgress::SUCCEEDED) && verdicts() == 1; }, kLimit));
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const DiagnosisVerdict& verdict = verdicts_.front();
    EXPECT_EQ(verdict.recording.empty(), false);
    EXPECT_EQ(verdict.file, response.files.front());
    EXPECT_EQ(verdict.header.frame_id, "0_link");
    EXPECT_EQ(verdict.joints.size(), verdict.joint_units.size());
    ASSERT_FALSE(verdict.causes.empty());
    const DiagnosisCause& cause = verdict.causes.front();
    EXPECT_EQ(cause.effect, "joint_offset");
    ASSERT_EQ(cause.joints, std::vector<std::string>{"elbow"});
    ASSERT_EQ(cause.parameters.size(), 1u);
    EXPECT_EQ(cause.parameters[0].unit, "rad");
    EXPECT_NEAR(cause.parameters[0].value, kOffset,
                std::max(0.1 * kOffset, 3.0 * cause.parameters[0].deviation));
    EXPECT_GT(verdict.gain, 0.8);
    EXPECT_LE(verdict.gain_lower, verdict.gain);
    std::set<std::string> phases;
    for (const WorkProgress& progress : states_) phases.insert(progress.phase);
    EXPECT_TRUE(phases.count("reading"));
    EXPECT_TRUE(phases.count("saving"));
  }
  // The file is a simulation that holds the cause.
  const SimulationConfig extended = loadSimulationConfig(response.files.front());
  EXPECT_NE(extended.find("joint_offset"), nullptr);

  // Files are never replaced.
  response = call(request);
  EXPECT_FALSE(response.success);
  EXPECT_NE(response.message.find("exists"), std::string::npos) << response.message;
  EXPECT_EQ(verdicts(), 1u);

  // A dry run has a verdict, and writes nothing: whatever the names.
  const auto written = [] {
    std::set<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(directory()))
      files.insert(entry.path().string());
    return files;
  };
  const std::set<std::string> before = written();
  request.dry_run = true;
  request.output = "dry.yaml";
  request.json = "dry.json";
  response = call(request);
  ASSERT_TRUE(response.success) << response.message;
  EXPECT_EQ(response.causes.front(), "joint_offset of elbow");
  EXPECT_NE(response.message.find("nothing written"), std::string::npos) << response.message;
  EXPECT_TRUE(response.files.empty());
  EXPECT_EQ(written(), before);
  EXPECT_TRUE(waitFor([&] { return verdicts() == 2; }, kLimit));
  const std::lock_guard<std::mutex> lock(mutex_);
  EXPECT_EQ(verdicts_.back().file, "");
}

TEST_F(Diagnoser, ACancelledDiagnosisChangesNothing) {
  SimulationConfig hidden = loadSimulationConfig(ros::package::getPath("raven_correction") +
                                                 "/config/simulation/nominal.yaml");
  hidden.set(effectWith("joint_offset", hidden.robot, {{"d[elbow]", kOffset}}));
  fs::create_directories(directory() + "/data");
  Dataset session = simulateSession(hidden, 12, 4);
  session.name = "cancelled";
  writeSessionBag(session, directory() + "/data/cancelled.bag");
  const auto cancel = [&] {
    std_srvs::Trigger call;
    EXPECT_TRUE(ros::service::call(nh_.resolveName("diagnoser/cancel"), call));
    return call.response;
  };
  const auto isRemoving = [&] {
    const std::lock_guard<std::mutex> lock(mutex_);
    return !states_.empty() && states_.back().state == WorkProgress::RUNNING &&
           states_.back().phase.find("removing") == 0;
  };
  EXPECT_FALSE(cancel().success);  // there is nothing to cancel

  // Late: causes were found, and are dropped in turn.
  Diagnose::Request request;
  request.inputs = {"cancelled.bag"};
  request.max_samples = 2000;
  request.max_causes = 2;
  request.output = "cancelled.yaml";
  request.json = "cancelled.json";
  auto answer = std::async(std::launch::async, [&] { return call(request); });
  ASSERT_TRUE(waitFor(isRemoving, kLimit));
  const std_srvs::Trigger::Response cancelled = cancel();
  EXPECT_TRUE(cancelled.success) << cancelled.message;
  ASSERT_EQ(answer.wait_for(std::chrono::duration<double>(kEndOfRound)), std::future_status::ready);
  Diagnose::Response response = answer.get();
  EXPECT_FALSE(response.success);
  EXPECT_EQ(response.message, "cancelled; nothing was changed");
  EXPECT_TRUE(response.causes.empty());
  EXPECT_TRUE(response.files.empty());
  EXPECT_TRUE(waitFor(
      [&] {
        const std::lock_guard<std::mutex> lock(mutex_);
        return states_.back().state == WorkProgress::FAILED &&
               states_.back().message == response.message;
      },
      kLimit));
  for (const char* const file : {"cancelled.yaml", "cancelled.json"})
    EXPECT_FALSE(fs::exists(directory() + "/simulations/" + file)) << file;
  EXPECT_FALSE(cancel().success);

  // The next one is as if there had been none, and its verdict the first of this recording.
  const auto verdictsOfIt = [&] {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::count_if(verdicts_.begin(), verdicts_.end(), [](const DiagnosisVerdict& verdict) {
      return verdict.recording == "cancelled";
    });
  };
  EXPECT_EQ(verdictsOfIt(), 0);
  request.max_samples = 400;
  request.dry_run = true;
  response = call(request);
  ASSERT_TRUE(response.success) << response.message;
  ASSERT_FALSE(response.causes.empty());
  EXPECT_EQ(response.causes.front(), "joint_offset of elbow");
  EXPECT_TRUE(waitFor([&] { return verdictsOfIt() == 1; }, kLimit));
}

/// The slave API of another node, as rosnode uses it.
class OtherNode {
 public:
  explicit OtherNode(const std::string& name) {
    XmlRpc::XmlRpcValue request, response, payload;
    request[0] = ros::this_node::getName();
    request[1] = name;
    known_ = ros::master::execute("lookupNode", request, response, payload, false) &&
             ros::network::splitURI(static_cast<std::string&>(payload), host_, port_);
  }
  /// Process id; 0 if the node does not say.
  int pid() {
    XmlRpc::XmlRpcValue response;
    return execute("getPid", response) ? static_cast<int>(response[2]) : 0;
  }
  /// Asks it to shut down, as `rosnode kill` does.
  bool shutDown() {
    XmlRpc::XmlRpcValue response;
    return execute("shutdown", response);
  }

 private:
  bool execute(const char* method, XmlRpc::XmlRpcValue& response) {
    if (!known_) return false;
    XmlRpc::XmlRpcClient client(host_.c_str(), static_cast<int>(port_), "/");
    XmlRpc::XmlRpcValue request;
    request[0] = ros::this_node::getName();
    if (std::string(method) == "shutdown") request[1] = "test";
    return client.execute(method, request, response);
  }
  std::string host_;
  std::uint32_t port_ = 0;
  bool known_ = false;
};

/// A process that has ended but was not waited for yet counts as gone.
bool isRunning(int pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string text;
  if (!std::getline(file, text)) return false;
  const std::size_t name_end = text.rfind(')');
  return name_end == std::string::npos || text.compare(name_end, 3, ") Z") != 0;
}

TEST_F(Diagnoser, AShutdownEndsTheWork) {
  SimulationConfig hidden = loadSimulationConfig(ros::package::getPath("raven_correction") +
                                                 "/config/simulation/demo.yaml");
  fs::create_directories(directory());
  const std::string bag = directory() + "/long.bag";
  writeSessionBag(simulateSession(hidden, 40, 4), bag);
  std::atomic<bool> running{false};
  const ros::Subscriber progress =
      nh_.subscribe<WorkProgress>("victim/progress", 100, [&](const auto& msg) {
        if (msg->state == WorkProgress::RUNNING && msg->phase != "reading") running = true;
      });
  ASSERT_TRUE(ros::service::waitForService(nh_.resolveName("victim/diagnose"), 30000));
  auto answer = std::async(std::launch::async, [&] {
    Diagnose service;
    service.request.inputs = {bag};
    return ros::service::call(nh_.resolveName("victim/diagnose"), service) &&
           service.response.success;
  });
  ASSERT_TRUE(waitFor([&] { return running.load(); }, kLimit));
  OtherNode victim(nh_.resolveName("victim"));
  const int pid = victim.pid();
  ASSERT_GT(pid, 0);
  ASSERT_TRUE(isRunning(pid));
  ASSERT_TRUE(victim.shutDown());
  EXPECT_EQ(answer.wait_for(std::chrono::duration<double>(kLimit)), std::future_status::ready);
  EXPECT_FALSE(answer.get());
  // The client is dropped at once; the process ends when the work does, and that is long before the
  // diagnosis would be through.
  EXPECT_TRUE(waitFor([&] { return !isRunning(pid); }, kEndOfRound));
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  return raven_correction::runNodeTests(argc, argv, "test_diagnoser");
}
