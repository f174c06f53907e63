// SPDX-License-Identifier: BSD-3-Clause
// ./run bench corrector: how long a pose takes from a planner through the corrector to a
// subscriber, as a node and as a nodelet, beside a relay node that does nothing, in one run: same
// message, same transport. The three take turns of a second, so that none pays for another.
#include <geometry_msgs/PoseStamped.h>
#include <nodelet/loader.h>
#include <raven_correction/CorrectionStatus.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <CLI/CLI.hpp>
#include <array>
#include <fstream>
#include <iostream>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "bench/support/durations.h"
#include "bench/support/instrument.h"
#include "bench/support/own_master.h"
#include "bench/support/relay.h"
#include "bench/support/shipped_size.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/model_file.h"
#include "raven_correction/ros/realtime.h"

namespace {

using namespace raven_correction;         // NOLINT: a program of one file
using namespace raven_correction::bench;  // NOLINT
using geometry_msgs::PoseStamped;

constexpr double kTurn = 1.0;     ///< of one path at a time [s]
constexpr double kSettled = 0.1;  ///< poses from here on in a turn are timed [s]

/// One way from the planner to the subscriber.
class Path {
 public:
  explicit Path(const std::string& name) : name_(name) {
    ros::NodeHandle nh("/" + name);
    nh.setCallbackQueue(&queue_);
    const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
    publisher_ = nh.advertise<PoseStamped>("desired/servo_cp", 1);
    commands_ = nh.subscribe<PoseStamped>(
        "servo_cp", 10000,
        [this](const PoseStamped::ConstPtr& message) { onCommand(message->header.stamp); },
        ros::VoidConstPtr(), hints);
    statuses_ = nh.subscribe<CorrectionStatus>(
        "correction/status", 10000,
        [this](const CorrectionStatus::ConstPtr& status) { onStatus(*status); });
    doFirst(queue_, becomeInstrument);
    spinner_ = std::make_unique<ros::AsyncSpinner>(1, &queue_);
    spinner_->start();
  }
  ~Path() { spinner_->stop(); }

  const std::string& name() const { return name_; }
  bool connected() const {
    return publisher_.getNumSubscribers() > 0 && commands_.getNumPublishers() > 0;
  }
  /// Messages sent from here on in this turn are timed only if they are sent after `settled`.
  void startTurn(const ros::Time& settled) {
    const std::lock_guard<std::mutex> lock(mutex_);
    settled_ = settled;
  }
  /// Forgets what was measured: the warming up is over.
  void startMeasuring() {
    const std::lock_guard<std::mutex> lock(mutex_);
    latency_.clear();
    callback_.clear();
    codes_.clear();
    sent_ = received_ = reordered_ = 0;
  }
  void send(const Pose& desired) {
    auto message = boost::make_shared<PoseStamped>();
    message->header.frame_id = "0_link";
    message->pose = poseToMsg(desired);
    message->header.stamp = ros::Time::now();
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      ++sent_;
    }
    publisher_.publish(message);
  }
  nlohmann::json result() {
    const std::lock_guard<std::mutex> lock(mutex_);
    nlohmann::json result = percentiles(latency_);
    result["sent"] = sent_;
    result["missed"] = sent_ - received_;
    result["reordered"] = reordered_;
    for (const auto& [code, count] : codes_) result["codes"][std::to_string(code)] = count;
    return result;
  }
  nlohmann::json callback() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return percentiles(callback_);
  }

 private:
  void onCommand(const ros::Time& stamp) {
    const ros::Time now = ros::Time::now();
    const std::lock_guard<std::mutex> lock(mutex_);
    ++received_;
    if (stamp <= last_) ++reordered_;
    last_ = stamp;
    if (stamp >= settled_) latency_.push_back(1e6 * (now - stamp).toSec());
  }
  void onStatus(const CorrectionStatus& status) {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++codes_[status.code];
    if (status.header.stamp >= settled_) callback_.push_back(1e6 * status.compute_time);
  }

  const std::string name_;
  ros::CallbackQueue queue_;

  std::mutex mutex_;  // of the members below
  ros::Time settled_, last_;
  std::vector<double> latency_, callback_;  // [us]
  std::uint64_t sent_ = 0, received_ = 0, reordered_ = 0;
  std::map<int, std::uint64_t> codes_;  // what the corrector said

  ros::Publisher publisher_;
  ros::Subscriber commands_, statuses_;
  std::unique_ptr<ros::AsyncSpinner> spinner_;
};

/// A turn of one path. @return processor time of `process` meanwhile [s]
double turn(Path& path, double rate, double seconds, pid_t process) {
  const auto begin = std::chrono::steady_clock::now();
  path.startTurn(ros::Time::now() + ros::Duration(kSettled));
  const double before = process > 0 ? processorTime(process) : 0.0;
  const auto count = static_cast<long>(rate * seconds);
  for (long i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / rate;
    std::this_thread::sleep_until(begin + std::chrono::duration<double>(t));
    path.send({{0.03 * std::sin(t), 0.02 * std::cos(0.7 * t), 0.0},
               expRotation({0.05 * std::sin(t), 0.0, 0.02})});
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(100));  // for what is still on its way
  return process > 0 ? processorTime(process) - before : 0.0;
}

void print(const nlohmann::json& result) {
  const auto row = [&](const char* name, const nlohmann::json& values) {
    std::printf("%-14s %9.1f %9.1f %9.1f %9.1f\n", name, values["p50_us"].get<double>(),
                values["p99_us"].get<double>(), values["p999_us"].get<double>(),
                values["max_us"].get<double>());
  };
  std::printf("%-14s %9s %9s %9s %9s\n", "[us]", "p50", "p99", "p99.9", "max");
  for (const char* const name : {"relay", "node", "nodelet", "callback"}) row(name, result[name]);
  std::printf("node - relay   %9.1f %9.1f\n", result["added"]["p50_us"].get<double>(),
              result["added"]["p99_us"].get<double>());
  for (const char* const name : {"relay", "node", "nodelet"})
    std::printf("%s: %lu poses, %lu missed, %lu reordered\n", name,
                result[name]["sent"].get<unsigned long>(),
                result[name]["missed"].get<unsigned long>(),
                result[name]["reordered"].get<unsigned long>());
  std::printf("share of one processor: relay %.3f, node %.3f\n",
              result["relay"]["cpu_share"].get<double>(),
              result["node"]["cpu_share"].get<double>());
  std::printf("real-time priority: relay %d, node %d\n",
              result["relay"]["realtime_priority"].get<int>(),
              result["node"]["realtime_priority"].get<int>());
  std::printf("a loop that does nothing is interrupted %lu times a second:\n",
              result["machine"]["per_second"].get<unsigned long>());
  row("interruption", result["machine"]);
}

nlohmann::json measure(OwnMaster& master, double seconds, double rate, pid_t relay, pid_t node) {
  std::array<Path, 3> paths{{Path("relay"), Path("node"), Path("nodelet")}};
  const std::array<pid_t, 3> processes{relay, node, 0};  // the nodelet is in this one
  for (const Path& path : paths)
    waitUntil(
        [&] {
          master.checkAlive();
          return path.connected();
        },
        "the topics of " + path.name());
  makeSocketsInstrument();
  becomeInstrument();
  for (Path& path : paths) turn(path, rate, 2.0, 0);  // warming up
  for (Path& path : paths) path.startMeasuring();

  std::array<double, 3> processor{};
  const auto turns = static_cast<int>(std::lround(std::max(1.0, seconds / kTurn)));
  for (int i = 0; i < turns; ++i) {
    master.checkAlive();
    for (std::size_t k = 0; k < paths.size(); ++k)
      processor[k] += turn(paths[k], rate, kTurn, processes[k]);
  }
  nlohmann::json result;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    result[paths[k].name()] = paths[k].result();
    if (processes[k] == 0) continue;
    result[paths[k].name()]["cpu_share"] = processor[k] / (turns * kTurn);
    result[paths[k].name()]["realtime_priority"] = realtimePriority(processes[k]);
  }
  result["callback"] = paths[1].callback();
  for (const char* const key : {"p50_us", "p99_us"})
    result["added"][key] = result["node"][key].get<double>() - result["relay"][key].get<double>();
  for (const char* const key : {"sent", "missed", "reordered"}) result[key] = result["node"][key];
  result["rate"] = rate;
  result["seconds"] = turns * kTurn;
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  if (isRelay(argc, argv)) return relayMain(argc, argv);
  CLI::App app{"Latency of the corrector beside a bare relay"};
  double seconds = 20.0, rate = 1000.0;
  std::optional<int> priority;
  int busy = 0;
  std::string json;
  app.add_option("--seconds", seconds, "how long each of the three is measured [s]")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1e5));
  app.add_option("--rate", rate, "poses per second [1/s]")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 5e3));
  app.add_option("--realtime-priority", priority,
                 "of relay and node; that of robot.launch unless given; 0: none")
      ->check(CLI::Range(0, kHighestRealtimePriority));
  app.add_option("--busy", busy, "so many programs that compute all the while, beside")
      ->check(CLI::Range(0, 64));
  app.add_option("--json", json, "write the figures to this file");
  CLI11_PARSE(app, argc, argv);
  try {
    const nlohmann::json machine = interruptions();
    OwnMaster master("bench");
    std::cerr << "fitting a model of the shipped size\n";
    const std::string model = (master.folder() / "model.bag").string();
    writeModelFile(modelOfShippedSize(), model, true);
    for (const char* const ns : {"node", "nodelet"}) {
      const ros::NodeHandle nh(std::string("/") + ns + "/corrector");
      nh.setParam("model", model);
      nh.setParam("enabled", true);
    }
    if (!priority) priority = launchedPriority();
    ros::param::set("/node/corrector/realtime_priority", *priority);
    const pid_t relay = startRelay(master, "relay", *priority);
    const pid_t node = master.startNode("corrector", "node");
    // The nodelet lives in this process, as with planner and controller in a nodelet manager.
    nodelet::Loader loader(/*provide_ros_api=*/false);
    if (!loader.load("/nodelet/corrector", "raven_correction/corrector", {}, {}))
      throw std::runtime_error("the nodelet could not be loaded");
    for (int i = 0; i < busy; ++i)
      master.start("busy_" + std::to_string(i), {"/bin/sh", "-c", "while :; do :; done"});
    std::cerr << "measuring each of the three for " << seconds << " s\n";
    nlohmann::json result = measure(master, seconds, rate, relay, node);
    result["machine"] = machine;
    result["busy"] = busy;
    print(result);
    if (!json.empty()) std::ofstream(json) << result.dump(2) << "\n";
  } catch (const std::exception& error) {
    std::cerr << "bench corrector: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
