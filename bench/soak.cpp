// SPDX-License-Identifier: BSD-3-Clause
// ./run soak: a planner at 1 kHz through the corrector, beside a relay that does nothing, and
// cameras at 480 Hz, everything recorded, for half an hour in real time. Every message is numbered
// by its stamp: what is lost on the way, what changes its order, what is missing in the bag?
#include <geometry_msgs/PoseStamped.h>
#include <raven_correction/CorrectionStatus.h>
#include <raven_correction/StartRecording.h>
#include <raven_correction/StopRecording.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "bench/support/instrument.h"
#include "bench/support/own_master.h"
#include "bench/support/relay.h"
#include "bench/support/shipped_size.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/model_file.h"
#include "raven_correction/ros/realtime.h"
#include "raven_correction/ros/topics.h"

namespace {

using namespace raven_correction;         // NOLINT: a program of one file
using namespace raven_correction::bench;  // NOLINT
using geometry_msgs::PoseStamped;

constexpr double kPlannerRate = 1000.0, kCameraRate = 480.0;  // [1/s]
/// Messages count from here on: by then every connection stands, also those between other nodes.
constexpr double kWarmingUp = 5.0;  // [s]
constexpr char kArm[] = "arm";
constexpr double kLeastShare = 0.9;    ///< of the planner's poses that have to be sent
constexpr double kLongestStall = 0.1;  ///< that the corrector alone may have [s]

/// The stamps of a stream, in the order in which they were seen [ns].
using Stamps = std::vector<std::uint64_t>;

Stamps ordered(Stamps stamps) {
  std::sort(stamps.begin(), stamps.end());
  return stamps;
}

/// How many of `all` are not in `part`. @param all, part  ordered
std::size_t missing(const Stamps& all, const Stamps& part) {
  Stamps rest;
  std::set_difference(all.begin(), all.end(), part.begin(), part.end(), std::back_inserter(rest));
  return rest.size();
}

/// Of poses that did not come on one way and came on the other: how many, in how many stalls (what
/// no pose that came parts is one), and the longest time between two poses that came where one was
/// lost [s]. @param sent  in the order in which they were
nlohmann::json missedAlone(const Stamps& sent, const Stamps& one, const Stamps& other) {
  const Stamps here = ordered(one), there = ordered(other);
  std::size_t poses = 0, stalls = 0;
  double longest = 0.0;
  bool stalled = false;
  std::uint64_t came = sent.empty() ? 0 : sent.front();
  const auto endStall = [&](std::uint64_t stamp) {
    if (stalled) longest = std::max(longest, 1e-9 * static_cast<double>(stamp - came));
    stalled = false;
    came = stamp;
  };
  for (const std::uint64_t stamp : sent) {
    if (std::binary_search(here.begin(), here.end(), stamp)) {
      endStall(stamp);
    } else if (std::binary_search(there.begin(), there.end(), stamp)) {
      ++poses;
      stalls += stalled ? 0 : 1;
      stalled = true;
    }
  }
  if (!sent.empty()) endStall(sent.back());
  return {{"poses", poses}, {"stalls", stalls}, {"longest_s", longest}};
}

/// Those from `first` on.
Stamps since(std::uint64_t first, const Stamps& stamps) {
  Stamps counted;
  std::copy_if(stamps.begin(), stamps.end(), std::back_inserter(counted),
               [&](std::uint64_t stamp) { return stamp >= first; });
  return counted;
}

std::size_t reordered(const Stamps& stamps) {
  std::size_t count = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i) count += stamps[i] <= stamps[i - 1];
  return count;
}

/// Keeps the stamps of a topic, in a thread of its own.
template <typename Message>
class Listener {
 public:
  Listener(const std::string& topic, std::size_t expected) {
    stamps_.reserve(expected);
    ros::NodeHandle nh;
    nh.setCallbackQueue(&queue_);
    subscriber_ = nh.subscribe<Message>(
        topic, 100000,
        [this](const boost::shared_ptr<Message const>& message) {
          stamps_.push_back(message->header.stamp.toNSec());
        },
        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
    doFirst(queue_, becomeInstrument);
    spinner_ = std::make_unique<ros::AsyncSpinner>(1, &queue_);
    spinner_->start();
  }
  bool connected() const { return subscriber_.getNumPublishers() > 0; }
  /// No message comes any more. @return what came, in that order
  const Stamps& stop() {
    spinner_->stop();
    queue_.callAvailable();
    return stamps_;
  }

 private:
  ros::CallbackQueue queue_;
  Stamps stamps_;
  ros::Subscriber subscriber_;
  std::unique_ptr<ros::AsyncSpinner> spinner_;
};

/// Publishes poses at a rate until it is told to stop.
class Source {
 public:
  Source(const std::vector<std::string>& topics, const std::string& frame, double rate,
         std::size_t expected)
      : frame_(frame), rate_(rate) {
    ros::NodeHandle nh;
    for (const std::string& topic : topics)
      publishers_.push_back(nh.advertise<PoseStamped>(topic, 1000));
    stamps_.reserve(expected);
  }
  bool connected(std::uint32_t subscribers) const {
    return std::all_of(publishers_.begin(), publishers_.end(),
                       [&](const ros::Publisher& publisher) {
                         return publisher.getNumSubscribers() >= subscribers;
                       });
  }
  void run(const std::atomic<bool>& stop) {
    becomeInstrument();
    const auto begin = std::chrono::steady_clock::now();
    for (long i = 0; !stop; ++i) {
      // What was slept through is left out: no burst follows.
      const std::chrono::duration<double> late = std::chrono::steady_clock::now() - begin;
      i = std::max(i, static_cast<long>(late.count() * rate_));
      const double t = static_cast<double>(i) / rate_;
      std::this_thread::sleep_until(begin + std::chrono::duration<double>(t));
      const auto message = boost::make_shared<PoseStamped>();
      message->header.frame_id = frame_;
      message->pose = poseToMsg({{0.03 * std::sin(t), 0.02 * std::cos(0.7 * t), 0.0},
                                 expRotation({0.05 * std::sin(t), 0.0, 0.02})});
      message->header.stamp = ros::Time::now();
      stamps_.push_back(message->header.stamp.toNSec());
      for (const ros::Publisher& publisher : publishers_) publisher.publish(message);
    }
  }
  const Stamps& stamps() const { return stamps_; }

 private:
  const std::string frame_;
  const double rate_;
  std::vector<ros::Publisher> publishers_;
  Stamps stamps_;
};

std::map<std::string, Stamps> stampsInBag(const std::string& file) {
  std::map<std::string, Stamps> stamps;
  rosbag::Bag bag(file, rosbag::bagmode::Read);
  rosbag::View view(bag);
  for (const rosbag::MessageInstance& instance : view)
    if (const auto pose = instance.instantiate<PoseStamped>())
      stamps[instance.getTopic()].push_back(pose->header.stamp.toNSec());
  return stamps;
}

template <typename Service>
typename Service::Response call(const std::string& name, typename Service::Request request) {
  typename Service::Response response;
  const std::string service = std::string("/") + kArm + "/recorder/" + name;
  if (!ros::service::waitForService(service, ros::Duration(30.0)) ||
      !ros::service::call(service, request, response) || !response.success)
    throw std::runtime_error(service + ": " + response.message);
  return response;
}

/// A stream on its way: {"sent", "arrived", "missed", "reordered"}.
nlohmann::json passage(const Stamps& sent, const Stamps& arrived) {
  return {{"sent", sent.size()},
          {"arrived", arrived.size()},
          {"missed", missing(ordered(sent), ordered(arrived))},
          {"reordered", reordered(arrived)}};
}

nlohmann::json soak(OwnMaster& master, double seconds, const std::string& bag) {
  const auto planner_count = static_cast<std::size_t>(1.1 * kPlannerRate * seconds) + 10000;
  const std::string arm = std::string("/") + kArm + "/";
  Source planner({arm + topics::kDesired, std::string("/relay/") + topics::kDesired}, "0_link",
                 kPlannerRate, planner_count);
  Source cameras({arm + topics::kMocap}, "0_link", kCameraRate, planner_count);
  Listener<PoseStamped> relayed(std::string("/relay/") + topics::kCommand, planner_count);
  Listener<PoseStamped> commands(arm + topics::kCommand, planner_count);
  Listener<CorrectionStatus> statuses(arm + topics::kStatus, planner_count);
  waitUntil(
      [&] {
        master.checkAlive();
        return planner.connected(1) && cameras.connected(1) && relayed.connected() &&
               commands.connected() && statuses.connected();
      },
      "the nodes");
  StartRecording::Request start;
  start.bag = bag;
  call<StartRecording>("start", start);

  makeSocketsInstrument();
  const std::uint64_t first = (ros::Time::now() + ros::Duration(kWarmingUp)).toNSec();
  std::atomic<bool> stop{false};
  std::thread camera_thread([&] { cameras.run(stop); });
  std::thread planner_thread([&] { planner.run(stop); });
  std::string failure;
  const ros::SteadyTime end = ros::SteadyTime::now() + ros::WallDuration(kWarmingUp + seconds);
  for (int i = 1; ros::SteadyTime::now() < end && failure.empty(); ++i) {
    ros::WallDuration(std::min(1.0, (end - ros::SteadyTime::now()).toSec())).sleep();
    try {
      master.checkAlive();
    } catch (const std::exception& error) {
      failure = error.what();
    }
    if (i % 60 == 0) std::cerr << "soak: " << i / 60 << " min\n";
  }
  stop = true;
  planner_thread.join();
  camera_thread.join();
  if (!failure.empty()) throw std::runtime_error(failure);
  ros::WallDuration(2.0).sleep();  // for what is still on its way
  call<StopRecording>("stop", {});

  const Stamps planned = since(first, planner.stamps()), seen = since(first, cameras.stamps());
  const Stamps by_relay = since(first, relayed.stop()), commanded = since(first, commands.stop());
  nlohmann::json result;
  result["relay"] = passage(planned, by_relay);
  result["corrector"] = passage(planned, commanded);
  result["corrector"]["alone"] = missedAlone(planned, commanded, by_relay);
  result["relay"]["alone"] = missedAlone(planned, by_relay, commanded);
  result["corrector"]["statuses"] = since(first, statuses.stop()).size();
  const auto recorded = stampsInBag(bag);
  const auto inBag = [&](const char* topic, const Stamps& published) {
    const auto found = recorded.find(topic);
    return passage(published, found == recorded.end() ? Stamps() : since(first, found->second));
  };
  result["bag"][topics::kDesired] = inBag(topics::kDesired, planned);
  result["bag"][topics::kCommand] = inBag(topics::kCommand, commanded);
  result["bag"][topics::kMocap] = inBag(topics::kMocap, seen);
  result["seconds"] = seconds;
  return result;
}

/// What must not be, in words; empty: nothing.
std::string verdict(const nlohmann::json& result) {
  std::string text;
  for (const auto& [topic, stream] : result["bag"].items())
    if (stream["missed"] > 0 || stream["reordered"] > 0)
      text += "the bag lacks messages of " + topic + ", or has them in another order\n";
  for (const char* const name : {"relay", "corrector"})
    if (result[name]["reordered"] > 0) text += std::string(name) + " changed the order\n";
  if (result["relay"]["sent"].get<double>() <
      kLeastShare * kPlannerRate * result["seconds"].get<double>())
    text += "the planner itself stood still: the machine is too busy for this\n";
  if (result["corrector"]["alone"]["longest_s"].get<double>() > kLongestStall)
    text += "the corrector let poses wait, or lost them, for longer than a stall\n";
  // Both have a queue of one: a machine that is busy for a millisecond takes poses from both, or
  // from either, by chance. More than chance has a cause. A stall that only one of them feels is as
  // likely to be the one's as the other's (McNemar's test, doi:10.1007/BF02295996).
  const auto relay = result["relay"]["alone"]["stalls"].get<double>();
  const auto corrector = result["corrector"]["alone"]["stalls"].get<double>();
  if (corrector > relay + 3.0 * std::sqrt(relay + corrector))
    text += "the corrector lost more poses than the relay, and not by chance\n";
  return text;
}

void print(const nlohmann::json& result) {
  const auto row = [](const std::string& name, const nlohmann::json& stream) {
    std::printf("%-32s %9lu %9lu %9lu %9lu\n", name.c_str(), stream["sent"].get<unsigned long>(),
                stream["arrived"].get<unsigned long>(), stream["missed"].get<unsigned long>(),
                stream["reordered"].get<unsigned long>());
  };
  std::printf("%.0f s\n%-32s %9s %9s %9s %9s\n", result["seconds"].get<double>(), "", "sent",
              "arrived", "missed", "reordered");
  row("planner -> relay", result["relay"]);
  row("planner -> corrector", result["corrector"]);
  for (const auto& [topic, stream] : result["bag"].items()) row("recorded " + topic, stream);
  for (const char* const name : {"relay", "corrector"})
    std::printf("missed by the %s alone: %lu, in %lu stalls, the longest of %.4f s\n", name,
                result[name]["alone"]["poses"].get<unsigned long>(),
                result[name]["alone"]["stalls"].get<unsigned long>(),
                result[name]["alone"]["longest_s"].get<double>());
}

}  // namespace

int main(int argc, char** argv) {
  if (isRelay(argc, argv)) return relayMain(argc, argv);
  CLI::App app{"Counts messages through corrector and recorder for a long time"};
  double minutes = 30.0;
  std::string json;
  app.add_option("--minutes", minutes, "how long [min]")
      ->capture_default_str()
      ->check(CLI::Range(0.01, 1e4));
  app.add_option("--json", json, "write the figures to this file");
  CLI11_PARSE(app, argc, argv);
  try {
    OwnMaster master("soak");
    const std::string model = (master.folder() / "model.bag").string();
    writeModelFile(modelOfShippedSize(), model, true);
    const ros::NodeHandle nh(std::string("/") + kArm);
    nh.setParam("corrector/model", model);
    nh.setParam("corrector/enabled", true);
    const int priority = launchedPriority();
    nh.setParam("corrector/realtime_priority", priority);
    nh.setParam("recorder/directory", master.folder().string());
    const pid_t relay = startRelay(master, "relay", priority);
    const pid_t corrector = master.startNode("corrector", kArm);
    master.startNode("recorder", kArm);
    std::cerr << "soak: " << minutes << " min in real time, bag in " << master.folder() << "\n";
    nlohmann::json result = soak(master, 60.0 * minutes, (master.folder() / "soak.bag").string());
    result["relay"]["realtime_priority"] = realtimePriority(relay);
    result["corrector"]["realtime_priority"] = realtimePriority(corrector);
    print(result);
    if (!json.empty()) std::ofstream(json) << result.dump(2) << "\n";
    const std::string faults = verdict(result);
    std::cout << (faults.empty() ? "nothing was lost that may not be\n" : faults);
    if (faults.empty()) return 0;
    master.keepFolder();
    std::cout << "the bag and what the nodes said is in " << master.folder().string() << "\n";
  } catch (const std::exception& error) {
    std::cerr << "soak: " << error.what() << "\n";
  }
  return 1;
}
