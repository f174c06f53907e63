// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/session_bag.h"

#include <raven_correction/TrajectoryEvent.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Header.h>
#include <tf2/buffer_core.h>
#include <tf2/exceptions.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <new>
#include <set>
#include <stdexcept>

#include "raven_correction/dataset/topic_check.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/bag_file.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/names.h"
#include "raven_correction/ros/stamp_order.h"
#include "raven_correction/ros/topics.h"
#include "session_parts.h"

namespace raven_correction {
namespace {

namespace fs = std::filesystem;

constexpr double kAfterEnd = 0.5;  ///< observations come later than commands [s]
constexpr double kPause = 1.0;     ///< without events, a silence that ends a trajectory [s]

/// Streams of a whole session, each by increasing stamp.
struct RawStreams {
  std::map<std::string, PoseStream> poses;              ///< by topic
  std::map<std::string, std::set<std::string>> frames;  ///< by topic
  std::map<std::string, StampOrder> order;              ///< by topic
  std::map<std::string, std::size_t> zero_stamps;       ///< by topic
  std::map<std::string, std::string> other_types;       ///< by topic: what cannot be read there
  std::vector<double> homed_at;                         ///< [s]
  std::vector<TopicType> topics;                        ///< that are in the bag
  JointStream joints;
  std::vector<TrajectoryEvent> events;
  tf2::BufferCore registration;
};

/// Where a message stands, for what has to be said about it.
struct Place {
  const std::string& file;
  const std::string& topic;
  std::size_t number;  ///< on its topic in this file, from 1
  ros::Time received;
};

void checkOrder(const Place& place, const ros::Time& stamp, StampOrder& order) {
  const double back = order.add(stamp);
  if (back == 0.0) return;
  throw InvalidInput(
      format("%s: %s: message %zu has stamp %.6f, %.6f s before the %.6f of the message before it: "
             "a clock was set back, a bag was played in a loop, or two nodes publish there; keep "
             "what came before, `rosbag filter %s CUT.bag \"t.to_nsec() < %lu\"`, or with >= what "
             "came after",
             place.file.c_str(), place.topic.c_str(), place.number, stamp.toSec(), back,
             order.latest().toSec(), place.file.c_str(),
             static_cast<unsigned long>(place.received.toNSec())));
}

bool isPoseStream(const std::string& topic) {
  return topic == topics::kCommand || topic == topics::kMocap || topic == topics::kEncoder;
}

void take(const rosbag::MessageInstance& instance, const Place& place, RawStreams& raw) {
  if (isPoseStream(place.topic)) {
    const auto pose = instance.instantiate<geometry_msgs::PoseStamped>();
    if (!pose) {
      raw.other_types[place.topic] = instance.getDataType();
      return;
    }
    if (pose->header.stamp.isZero()) {  // by convention: not valid
      ++raw.zero_stamps[place.topic];
      return;
    }
    checkOrder(place, pose->header.stamp, raw.order[place.topic]);
    raw.poses[place.topic].push_back(stampedPoseFromMsg(*pose));
    raw.frames[place.topic].insert(withoutSlash(pose->header.frame_id));
  } else if (place.topic == topics::kJoints) {
    const auto joints = instance.instantiate<sensor_msgs::JointState>();
    if (!joints || joints->header.stamp.isZero()) return;
    checkOrder(place, joints->header.stamp, raw.order[place.topic]);
    raw.joints.names = joints->name;
    raw.joints.samples.push_back(
        {joints->header.stamp.toSec(),
         Eigen::Map<const Eigen::VectorXd>(joints->position.data(),
                                           static_cast<Eigen::Index>(joints->position.size()))});
  } else if (place.topic == topics::kRobotHomed) {
    const auto homing = instance.instantiate<std_msgs::Header>();
    if (homing && !homing->stamp.isZero()) raw.homed_at.push_back(homing->stamp.toSec());
  } else if (const auto event = instance.instantiate<TrajectoryEvent>()) {
    raw.events.push_back(*event);
  } else if (place.topic == topics::kTrajectoryEvent) {
    raw.other_types[place.topic] = instance.getDataType();
  } else if (const auto tf = instance.instantiate<tf2_msgs::TFMessage>()) {
    if (place.topic != withoutSlash(topics::kTfStatic)) return;
    for (const geometry_msgs::TransformStamped& transform : tf->transforms)
      raw.registration.setTransform(transform, "bag", true);
  }
}

/// The one frame of a topic, which must have a name.
std::string frameOf(const std::string& file, const char* topic, const RawStreams& raw) {
  const std::set<std::string>& frames = raw.frames.at(topic);
  if (frames.size() != 1)
    throw InvalidInput(format("%s: %s comes in %zu different frames; record one frame per topic",
                              file.c_str(), topic, frames.size()));
  if (frames.begin()->empty())
    throw InvalidInput(
        format("%s: the poses of %s name no frame (empty frame_id); let the source "
               "name it, or set the recorder's mocap_frame",
               file.c_str(), topic));
  return *frames.begin();
}

/// Puts encoder poses of another frame into the base frame; without a registration they are of no
/// use.
void registerEncoders(const std::string& file, const std::string& base, RawStreams& raw) {
  PoseStream& encoders = raw.poses[topics::kEncoder];
  if (encoders.empty()) return;
  const std::string frame = frameOf(file, topics::kEncoder, raw);
  if (frame == base) return;
  try {
    const Pose X_base_frame =
        poseFromMsg(raw.registration.lookupTransform(base, frame, ros::Time(0)).transform);
    for (StampedPose& sample : encoders) sample.pose = X_base_frame * sample.pose;
  } catch (const tf2::TransformException&) {
    encoders.clear();
  }
}

/// Puts observations of another frame into the base frame.
void registerObservations(const std::string& file, const std::string& base, RawStreams& raw) {
  const std::string mocap = frameOf(file, topics::kMocap, raw);
  if (mocap == base) return;
  Pose X_base_mocap;
  try {
    X_base_mocap =
        poseFromMsg(raw.registration.lookupTransform(base, mocap, ros::Time(0)).transform);
  } catch (const tf2::TransformException& error) {
    throw InvalidInput(
        format("%s: no registration of \"%s\" in \"%s\" in the bag's /tf_static "
               "(%s); publish it with static_transform_publisher while recording",
               file.c_str(), mocap.c_str(), base.c_str(), error.what()));
  }
  for (StampedPose& sample : raw.poses[topics::kMocap]) sample.pose = X_base_mocap * sample.pose;
}

std::vector<TrajectoryGoal> goalsFromEvents(std::vector<TrajectoryEvent> events) {
  std::stable_sort(events.begin(), events.end(),
                   [](const TrajectoryEvent& a, const TrajectoryEvent& b) {
                     return a.header.stamp < b.header.stamp;
                   });
  std::vector<TrajectoryGoal> goals;
  for (const TrajectoryEvent& event : events) {
    const double stamp = event.header.stamp.toSec();
    const bool open = !goals.empty() && goals.back().end == std::numeric_limits<double>::infinity();
    if (event.event == TrajectoryEvent::START) {
      if (open) goals.back().end = stamp;
      TrajectoryGoal goal;
      goal.trajectory = event.trajectory;
      goal.start = stamp;
      goal.end = std::numeric_limits<double>::infinity();
      goal.target = poseFromMsg(event.target);
      goal.has_target = isFinite(goal.target) && hasUnitQuaternion(goal.target);
      goals.push_back(goal);
    } else if (open && goals.back().trajectory == event.trajectory) {
      goals.back().end = stamp;
      // An END whose target is not a pose says that the target of the START was not reached.
      if (!hasUnitQuaternion(poseFromMsg(event.target))) goals.back().has_target = false;
    }
  }
  return goals;
}

/// A recording without events: every longer silence of the commands ends a trajectory.
std::vector<TrajectoryGoal> goalsFromPauses(const PoseStream& commands) {
  std::vector<TrajectoryGoal> goals;
  for (const StampedPose& command : commands) {
    if (goals.empty() || command.stamp - goals.back().end > kPause) {
      TrajectoryGoal goal;
      goal.trajectory = format("t%03zu", goals.size());
      goal.start = command.stamp;
      goals.push_back(goal);
    }
    goals.back().end = command.stamp;
  }
  return goals;
}

PoseStream between(const PoseStream& stream, double start, double end) {
  const auto earlier = [](const StampedPose& sample, double t) { return sample.stamp < t; };
  const auto later = [](double t, const StampedPose& sample) { return t < sample.stamp; };
  return {std::lower_bound(stream.begin(), stream.end(), start, earlier),
          std::upper_bound(stream.begin(), stream.end(), end, later)};
}

Trajectory cut(const RawStreams& raw, const TrajectoryGoal& goal, double next_start) {
  const double seen_until = std::min(goal.end + kAfterEnd, next_start);
  const auto stream = [&](const char* topic) {
    const auto found = raw.poses.find(topic);
    return found == raw.poses.end() ? PoseStream() : found->second;
  };
  Trajectory trajectory;
  trajectory.id = goal.trajectory;
  trajectory.commands = between(stream(topics::kCommand), goal.start, goal.end);
  trajectory.observations = between(stream(topics::kMocap), goal.start, seen_until);
  trajectory.encoders = between(stream(topics::kEncoder), goal.start, seen_until);
  trajectory.joint_observations.names = raw.joints.names;
  for (const StampedJoints& sample : raw.joints.samples)
    if (sample.stamp >= goal.start && sample.stamp <= seen_until)
      trajectory.joint_observations.samples.push_back(sample);
  return trajectory;
}

constexpr std::size_t kProgressMessages = 5000;  ///< between two calls of progress

void readMessages(const std::string& file, const ShareRead& progress, RawStreams& raw) {
  if (!fs::is_regular_file(file)) throw InvalidInput(format("%s: no such file", file.c_str()));
  const auto damaged = [&](const std::exception& error) {
    return InvalidInput(
        format("%s: not a complete bag (%s); if the recorder was killed, run "
               "`rosbag reindex %s`",
               file.c_str(), error.what(), file.c_str()));
  };
  try {
    const rosbag::Bag bag = openBagFile(file);
    rosbag::View view(bag);
    for (const rosbag::ConnectionInfo* connection : view.getConnections())
      raw.topics.push_back({withoutSlash(connection->topic), connection->datatype});
    const std::size_t all = view.size();
    std::size_t done = 0;
    std::map<std::string, std::size_t> count;  // by topic
    for (const rosbag::MessageInstance& instance : view) {
      const std::string topic = withoutSlash(instance.getTopic());
      take(instance, {file, topic, ++count[topic], instance.getTime()}, raw);
      if (progress && ++done % kProgressMessages == 0)
        progress(static_cast<double>(done) / static_cast<double>(all));
    }
  } catch (const ros::Exception& error) {  // of rosbag, or of a message that ends too soon
    throw damaged(error);
  } catch (const std::bad_alloc& error) {  // a length that a flipped bit has made huge
    throw damaged(error);
  } catch (const std::length_error& error) {
    throw damaged(error);
  }
}

/// What is needed is there, and of the type that it must have.
void checkTypes(const std::string& file, const RawStreams& raw) {
  for (const auto& [topic, type] :
       {std::make_pair(topics::kCommand, "geometry_msgs/PoseStamped"),
        std::make_pair(topics::kMocap, "geometry_msgs/PoseStamped"),
        std::make_pair(topics::kTrajectoryEvent, "raven_correction/TrajectoryEvent")}) {
    const auto other = raw.other_types.find(topic);
    if (other == raw.other_types.end()) continue;
    throw InvalidInput(
        format("%s: %s holds %s, expected %s of this version; the recorder writes it, whatever the "
               "robot sends (its ~pose_type): record with it, or convert the bag",
               file.c_str(), topic, other->second.c_str(), type));
  }
}

/// @throws InvalidInput  always: a stream is missing, with what is there instead
void refuseMissing(const std::string& file, const char* topic, const RawStreams& raw) {
  const auto zero = raw.zero_stamps.find(topic);
  if (zero != raw.zero_stamps.end())
    throw InvalidInput(
        format("%s: %s: all %zu stamps are zero, which means: not valid; let the driver fill the "
               "header, or set the recorder's mocap_stamp: receipt",
               file.c_str(), topic, zero->second));
  std::string text = format("%s: no message on %s", file.c_str(), topic);
  for (const StreamFinding& finding :
       checkTopics({{topic, "geometry_msgs/PoseStamped"}}, raw.topics))
    text += finding.what == "missing"
                ? format("; %s (in the recorder's launch file)", finding.remedy.c_str())
                : format(": %s, not %s", finding.measured.c_str(), finding.limit.c_str());
  throw InvalidInput(text + "; `rosbag info` lists what was recorded");
}

}  // namespace

ShareRead partOf(const ShareRead& progress, std::size_t i, std::size_t n) {
  if (!progress) return {};
  return [&progress, i, n](double share) {
    progress((static_cast<double>(i) + share) / static_cast<double>(n));
  };
}

Session readSessionParts(const std::vector<std::string>& parts, const ShareRead& progress) {
  const std::string& file = parts.front();  // for messages
  RawStreams raw;
  for (std::size_t i = 0; i < parts.size(); ++i)
    readMessages(parts[i], partOf(progress, i, parts.size()), raw);
  checkTypes(file, raw);
  for (const char* const topic : {topics::kCommand, topics::kMocap})
    if (raw.poses[topic].empty()) refuseMissing(file, topic, raw);
  const std::string base = frameOf(file, topics::kCommand, raw);
  registerEncoders(file, base, raw);
  registerObservations(file, base, raw);

  Session session;
  std::sort(raw.homed_at.begin(), raw.homed_at.end());
  raw.homed_at.erase(std::unique(raw.homed_at.begin(), raw.homed_at.end()), raw.homed_at.end());
  session.homed_at = raw.homed_at;
  session.dataset.source = file;
  session.dataset.name = fs::path(file).stem().string();
  session.dataset.frame = base;
  std::vector<TrajectoryGoal> goals = raw.events.empty()
                                          ? goalsFromPauses(raw.poses[topics::kCommand])
                                          : goalsFromEvents(raw.events);
  for (std::size_t i = 0; i < goals.size(); ++i) {
    const double next_start =
        i + 1 < goals.size() ? goals[i + 1].start : std::numeric_limits<double>::infinity();
    Trajectory trajectory = cut(raw, goals[i], next_start);
    if (trajectory.commands.empty()) continue;
    session.dataset.trajectories.push_back(std::move(trajectory));
    session.goals.push_back(goals[i]);
  }
  if (session.dataset.trajectories.empty())
    throw InvalidInput(
        format("%s: %zu commands, but none within the %zu trajectories that "
               "trajectory_event names; compare the stamps of both",
               file.c_str(), raw.poses[topics::kCommand].size(), goals.size()));
  return session;
}

Session readSessionBag(const std::string& file) { return readSessionParts({file}, {}); }

bool holdsSession(const std::string& file) {
  try {
    const rosbag::Bag bag = openBagFile(file, BagParts::kTopics);
    for (const rosbag::ConnectionInfo* connection : rosbag::View(bag).getConnections())
      if (withoutSlash(connection->topic) == topics::kMocap) return true;
  } catch (const ros::Exception&) {
  }
  return false;
}

namespace {

ros::Time bagTime(double stamp) {
  ros::Time time = ros::TIME_MIN;
  if (std::isfinite(stamp) && stamp > 0.0) time.fromSec(stamp);
  return std::max(time, ros::TIME_MIN);
}

void writeStream(rosbag::Bag& bag, const char* topic, const PoseStream& stream,
                 const std::string& frame) {
  for (const StampedPose& sample : stream)
    bag.write(topic, bagTime(sample.stamp), stampedPoseToMsg(sample.stamp, sample.pose, frame));
}

void writeTrajectory(rosbag::Bag& bag, const Trajectory& trajectory, const std::string& frame) {
  double first = trajectory.start(), last = first;
  for (const PoseStream* const stream :
       {&trajectory.commands, &trajectory.observations, &trajectory.encoders}) {
    if (stream->empty()) continue;
    first = std::min(first, stream->front().stamp);
    last = std::max(last, stream->back().stamp);
  }
  TrajectoryEvent event;
  event.header.stamp = bagTime(first);
  event.trajectory = trajectory.id;
  event.event = TrajectoryEvent::START;
  bag.write(topics::kTrajectoryEvent, event.header.stamp, event);
  writeStream(bag, topics::kCommand, trajectory.commands, frame);
  writeStream(bag, topics::kMocap, trajectory.observations, frame);
  writeStream(bag, topics::kEncoder, trajectory.encoders, frame);
  for (const StampedJoints& sample : trajectory.joint_observations.samples) {
    sensor_msgs::JointState joints;
    joints.header.stamp = bagTime(sample.stamp);
    joints.name = trajectory.joint_observations.names;
    joints.position.assign(sample.positions.data(),
                           sample.positions.data() + sample.positions.size());
    bag.write(topics::kJoints, joints.header.stamp, joints);
  }
  event.header.stamp = bagTime(last);
  event.event = TrajectoryEvent::END;
  bag.write(topics::kTrajectoryEvent, event.header.stamp, event);
}

}  // namespace

void writeSessionBag(const Dataset& dataset, const std::string& file) {
  for (const Trajectory& trajectory : dataset.trajectories)
    if (trajectory.commands.empty())
      throw InvalidInput(
          format("%s: trajectory %s has no stream of commanded poses, which a session's bag holds "
                 "(doc/bags.md); nothing was written: use the directory as it is",
                 dataset.source.c_str(), trajectory.id.c_str()));
  writeBagFile(file, /*overwrite=*/false, [&](rosbag::Bag& bag) {
    for (const Trajectory& trajectory : dataset.trajectories)
      writeTrajectory(bag, trajectory, dataset.frame);
  });
}

}  // namespace raven_correction
