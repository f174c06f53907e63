// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/model_file.h"

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <cmath>
#include <filesystem>

#include "raven_correction/error.h"
#include "raven_correction/ros/bag_file.h"
#include "raven_correction/ros/checked_stream.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/topics.h"

namespace raven_correction {
namespace {

namespace fs = std::filesystem;

constexpr char kUnits[] = "m rad";

std::vector<double> toVector(const Eigen::MatrixXd& matrix) {
  return {matrix.data(), matrix.data() + matrix.size()};
}

Eigen::MatrixXd toMatrix(const std::vector<double>& values, Eigen::Index rows, Eigen::Index columns,
                         const char* name) {
  if (static_cast<Eigen::Index>(values.size()) != rows * columns)
    throw InvalidInput(format("model: %s has %zu numbers, expected %ld x %ld", name, values.size(),
                              static_cast<long>(rows), static_cast<long>(columns)));
  return Eigen::Map<const Eigen::MatrixXd>(values.data(), rows, columns);
}

/// Lower triangle, column after column.
std::vector<double> packLower(const Eigen::MatrixXd& matrix) {
  std::vector<double> packed;
  packed.reserve(static_cast<std::size_t>(matrix.rows() * (matrix.rows() + 1) / 2));
  for (Eigen::Index column = 0; column < matrix.cols(); ++column)
    for (Eigen::Index row = column; row < matrix.rows(); ++row)
      packed.push_back(matrix(row, column));
  return packed;
}

// The factor may be of the first points only, so its size follows from its own length.
Eigen::MatrixXd unpackLower(const std::vector<double>& packed) {
  const auto length = static_cast<double>(packed.size());
  const auto size =
      static_cast<Eigen::Index>(std::lround(0.5 * (std::sqrt(8.0 * length + 1.0) - 1.0)));
  if (static_cast<Eigen::Index>(packed.size()) != size * (size + 1) / 2)
    throw InvalidInput(
        format("model: variance_factor has %zu numbers, which is no triangle; the "
               "message is cut or of another version",
               packed.size()));
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  std::size_t next = 0;
  for (Eigen::Index column = 0; column < size; ++column)
    for (Eigen::Index row = column; row < size; ++row) matrix(row, column) = packed[next++];
  return matrix;
}

GaussianProcess groupToMsg(const GpGroup& group) {
  GaussianProcess msg;
  for (const int output : group.outputs) msg.outputs.push_back(static_cast<std::uint8_t>(output));
  msg.kernel = kernelName(group.kernel);
  msg.length_scales = toVector(group.length_scales);
  msg.signal_variance = toVector(group.signal_variance);
  msg.noise_variance = toVector(group.noise_variance);
  msg.points = static_cast<std::uint32_t>(group.points.cols());
  msg.z = toVector(group.points);
  msg.alpha = toVector(group.weights);
  msg.mean_weights = toVector(group.mean_weights);
  msg.variance_factor = packLower(group.variance_factor);
  return msg;
}

GpGroup groupFromMsg(const GaussianProcess& msg, Eigen::Index features) {
  GpGroup group;
  for (const std::uint8_t output : msg.outputs) group.outputs.push_back(output);
  group.kernel = kernelFromName(msg.kernel);
  const auto outputs = static_cast<Eigen::Index>(msg.outputs.size());
  const auto points = static_cast<Eigen::Index>(msg.points);
  group.length_scales = toMatrix(msg.length_scales, features, 1, "length_scales");
  group.signal_variance = toMatrix(msg.signal_variance, outputs, 1, "signal_variance");
  group.noise_variance = toMatrix(msg.noise_variance, outputs, 1, "noise_variance");
  group.points = toMatrix(msg.z, features, points, "z");
  group.weights = toMatrix(msg.alpha, points, outputs, "alpha");
  group.mean_weights = toMatrix(msg.mean_weights, 1 + features, outputs, "mean_weights");
  group.variance_factor = unpackLower(msg.variance_factor);
  return group;
}

std::vector<std::uint8_t> bytesOf(const rosbag::MessageInstance& instance) {
  std::vector<std::uint8_t> bytes(instance.size());
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  instance.write(stream);
  return bytes;
}

}  // namespace

CorrectionModel modelToMsg(const Correction& model) {
  CorrectionModel msg;
  if (model.trained_at > 0.0) msg.header.stamp.fromSec(model.trained_at);
  msg.header.frame_id = model.frame;
  msg.format = CorrectionModel::FORMAT;
  msg.id = model.id;
  msg.version = model.version;
  msg.arm = model.arm;
  msg.tool = model.tool;
  msg.units = kUnits;
  msg.pose_type = model.pose_type;
  if (model.homed_at > 0.0) msg.homed.fromSec(model.homed_at);
  if (model.expires_at > 0.0) msg.expires.fromSec(model.expires_at);
  msg.inputs = model.inputs;
  msg.input_hash = model.input_hash;
  msg.configuration = model.configuration;
  msg.delay = model.delay;
  msg.speed_delay = model.speed_delay;
  msg.rigid = poseToMsg(model.rigid);
  msg.mean_orientation = poseToMsg({{}, model.mean_orientation}).orientation;
  msg.velocity = velocityName(model.motion.velocity);
  msg.velocity_window = model.motion.window;
  msg.velocity_intervals = model.motion.intervals;
  msg.max_gap = model.motion.max_gap;
  msg.play_length = model.motion.play_length;
  msg.play_angle = model.motion.play_angle;
  msg.play_robot = model.motion.robot;
  msg.joint_play_length = model.motion.joint_play_length;
  msg.joint_play_angle = model.motion.joint_play_angle;
  msg.joint_play_wrist = model.motion.joint_play_wrist;
  for (const GpGroup& group : model.process.groups) msg.groups.push_back(groupToMsg(group));
  msg.workspace_min = pointToMsg(model.trust.workspace_min);
  msg.workspace_max = pointToMsg(model.trust.workspace_max);
  msg.workspace_margin = model.trust.workspace_margin;
  msg.fade_start = model.trust.fade_start;
  msg.fade_end = model.trust.fade_end;
  msg.training_pairs = static_cast<std::uint32_t>(model.training_pairs);
  msg.training_trajectories = static_cast<std::uint32_t>(model.training_trajectories);
  msg.held_out_position_before = model.held_out.position_before;
  msg.held_out_angle_before = model.held_out.angle_before;
  msg.held_out_position_after = model.held_out.position_after;
  msg.held_out_angle_after = model.held_out.angle_after;
  msg.simulation = model.physics.texts.simulation;
  msg.simulation_robot = model.physics.texts.robot;
  msg.simulation_hold = model.physics.timing.hold;
  msg.simulation_age = model.physics.timing.age;
  return msg;
}

Correction modelFromMsg(const CorrectionModel& msg) {
  if (msg.format != CorrectionModel::FORMAT)
    throw InvalidInput(
        format("model %s has format %u, this program reads format %u; train it "
               "again with this version",
               msg.id.c_str(), msg.format, CorrectionModel::FORMAT));
  if (msg.units != kUnits)
    throw InvalidInput(format("model %s is in the units \"%s\", this program works in \"%s\"",
                              msg.id.c_str(), msg.units.c_str(), kUnits));
  Correction model;
  model.id = msg.id;
  model.version = msg.version;
  model.trained_at = msg.header.stamp.toSec();
  model.frame = msg.header.frame_id;
  model.arm = msg.arm;
  model.tool = msg.tool;
  model.pose_type = msg.pose_type;
  model.homed_at = msg.homed.toSec();
  model.expires_at = msg.expires.toSec();
  model.inputs = msg.inputs;
  model.input_hash = msg.input_hash;
  model.configuration = msg.configuration;
  model.delay = msg.delay;
  model.speed_delay = msg.speed_delay;
  model.rigid = poseFromMsg(msg.rigid);
  geometry_msgs::Pose orientation;
  orientation.orientation = msg.mean_orientation;
  model.mean_orientation = poseFromMsg(orientation).q;
  model.motion.velocity = velocityFromName(msg.velocity);
  model.motion.window = msg.velocity_window;
  model.motion.intervals = msg.velocity_intervals;
  model.motion.max_gap = msg.max_gap;
  model.motion.play_length = msg.play_length;
  model.motion.play_angle = msg.play_angle;
  model.motion.robot = msg.play_robot;
  model.motion.joint_play_length = msg.joint_play_length;
  model.motion.joint_play_angle = msg.joint_play_angle;
  model.motion.joint_play_wrist = msg.joint_play_wrist;
  checkMotionOptions(model.motion);
  if (!msg.groups.empty()) {
    const std::size_t features = featureCount(model.motion);
    model.process.features = static_cast<int>(features);
    model.process.outputs = 6;
    for (const GaussianProcess& group : msg.groups)
      model.process.groups.push_back(groupFromMsg(group, static_cast<Eigen::Index>(features)));
  }
  model.trust.workspace_min << msg.workspace_min.x, msg.workspace_min.y, msg.workspace_min.z;
  model.trust.workspace_max << msg.workspace_max.x, msg.workspace_max.y, msg.workspace_max.z;
  model.trust.workspace_margin = msg.workspace_margin;
  model.trust.fade_start = msg.fade_start;
  model.trust.fade_end = msg.fade_end;
  model.training_pairs = msg.training_pairs;
  model.training_trajectories = msg.training_trajectories;
  model.held_out.position_before = msg.held_out_position_before;
  model.held_out.angle_before = msg.held_out_angle_before;
  model.held_out.position_after = msg.held_out_position_after;
  model.held_out.angle_after = msg.held_out_angle_after;
  model.physics.texts = {msg.simulation, msg.simulation_robot};
  model.physics.timing = {msg.delay, msg.simulation_hold, msg.simulation_age};
  if (model.physics.empty()) model.physics = {};
  return model;
}

void writeModelFile(const Correction& model, const std::string& file, bool overwrite) {
  writeBagFile(file, overwrite, [&](rosbag::Bag& bag) {
    const CorrectionModel msg = modelToMsg(model);
    bag.write(topics::kModel, msg.header.stamp.isZero() ? ros::TIME_MIN : msg.header.stamp, msg);
  });
}

Correction readModelFile(const std::string& file) {
  if (!fs::exists(file))
    throw InvalidInput(format("%s: no such file; train a model first", file.c_str()));
  try {
    const rosbag::Bag bag = openBagFile(file);
    rosbag::View view(bag, rosbag::TopicQuery(topics::kModel));
    for (const rosbag::MessageInstance& instance : view)
      if (instance.isType<CorrectionModel>())
        return modelFromMsg(messageFromBytes<CorrectionModel>(bytesOf(instance)));
  } catch (const InvalidInput& error) {
    throw InvalidInput(format("%s: %s", file.c_str(), error.what()));
  } catch (const std::exception& error) {  // of rosbag, which trusts what it reads
    throw InvalidInput(format("%s: not a complete bag (%s); is it a model file, was it cut off?",
                              file.c_str(), error.what()));
  }
  throw InvalidInput(
      format("%s: holds no %s of type raven_correction/CorrectionModel of this "
             "version; is it a recording?",
             file.c_str(), topics::kModel));
}

}  // namespace raven_correction
