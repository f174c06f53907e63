// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/raven_state.h"

#include <array>

#include "raven_correction/geometry/rotation.h"
#include "raven_correction/ros/byte_reader.h"

namespace raven_correction {
namespace {

constexpr char kBerkeleyState[] = "2489ec3d939b556c05d31ea2958841b2";  // raven_2_msgs/RavenState
constexpr char kUwState[] = "ce9e7f4969049d8bb365de3c98461a01";        // raven_2/raven_state

constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180.0;
constexpr double kMicrometre = 1e-6;   // [m]
constexpr double kNoRotation = 1e-2;   // of R^T R from the identity; float32 is good to 1e-6 [-]
constexpr std::size_t kUwJoints = 16;  // of both arms
constexpr std::uint16_t kFinger1 = 6, kFinger2 = 7, kYaw = 8;

/// Of raven_2_msgs/Constants, and of the arrays of raven_2/raven_state; null: none of the chain.
const char* jointName(std::uint16_t type) {
  switch (type) {
    case 0:
      return "shoulder";
    case 1:
      return "elbow";
    case 2:
      return "insertion";
    case 4:
      return "tool_roll";
    case 5:
      return "wrist_pitch";
    case kFinger1:
      return "finger_1";
    case kFinger2:
      return "finger_2";
    case kYaw:
      return "wrist_yaw";
    default:
      return nullptr;
  }
}

/// Joints by type, as they are told; the yaw follows from the fingers where it is not.
void addJoints(const std::array<std::optional<double>, 9>& by_type, ArmMeasurement& arm) {
  std::array<std::optional<double>, 9> all = by_type;
  if (!all[kYaw] && all[kFinger1] && all[kFinger2])
    all[kYaw] = 0.5 * (*all[kFinger2] - *all[kFinger1]);
  for (std::uint16_t type = 0; type < all.size(); ++type) {
    if (!all[type] || jointName(type) == nullptr) continue;
    arm.joint_names.emplace_back(jointName(type));
    arm.positions.push_back(*all[type]);
  }
}

Pose readPose(ByteReader& reader) {
  Pose pose;
  for (Eigen::Index k = 0; k < 3; ++k) pose.p(k) = reader.number<double>();
  for (Eigen::Index k = 0; k < 4; ++k) pose.q.coeffs()(k) = reader.number<double>();
  return pose;
}

template <typename Number>
void skip(ByteReader& reader, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) reader.number<Number>();
}

std::optional<std::size_t> uwIndexOf(const std::string& arm) {
  if (arm == "gold" || arm == "left" || arm == "L") return 0;
  if (arm == "green" || arm == "right" || arm == "R") return 1;
  return std::nullopt;
}

/// Rotation of a row-major 3x3 in float32; a quaternion of length zero where it is none.
Eigen::Quaterniond rotationFrom(const Eigen::Matrix3d& R) {
  const bool is_rotation = (R.transpose() * R - Eigen::Matrix3d::Identity()).norm() < kNoRotation &&
                           R.determinant() > 0.0;
  if (!is_rotation) return {0.0, 0.0, 0.0, 0.0};
  return Eigen::Quaterniond(nearestRotation(R)).normalized();
}

bool readUw(ByteReader& reader, std::size_t index, ArmMeasurement& arm) {
  skip<std::int32_t>(reader, 3);  // runlevel, sublevel, last_seq
  skip<std::int32_t>(reader, 2);  // type
  for (std::size_t i = 0; i < 6; ++i) {
    const double micrometres = reader.number<std::int32_t>();
    if (i / 3 == index) arm.tool.p(static_cast<Eigen::Index>(i % 3)) = micrometres * kMicrometre;
  }
  Eigen::Matrix3d R = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < 18; ++i) {
    const double entry = static_cast<double>(reader.number<float>());
    if (i / 9 == index)
      R(static_cast<Eigen::Index>(i % 9 / 3), static_cast<Eigen::Index>(i % 3)) = entry;
  }
  arm.tool.q = rotationFrom(R);
  skip<float>(reader, 18);                    // ori_d
  skip<std::int32_t>(reader, 6 + 2);          // pos_d, dt
  skip<std::int32_t>(reader, 2 * kUwJoints);  // encVals, dac_val
  skip<float>(reader, 2 * kUwJoints);         // tau, mpos
  std::array<std::optional<double>, 9> joints;
  for (std::size_t i = 0; i < kUwJoints; ++i) {
    const double degrees = static_cast<double>(reader.number<float>());
    if (i / 8 == index && i % 8 != 3) joints[i % 8] = degrees * kRadiansPerDegree;
  }
  addJoints(joints, arm);
  skip<float>(reader, 4 * kUwJoints);  // mvel, jvel, mpos_d, jpos_d
  skip<float>(reader, 2);              // grasp_d
  skip<float>(reader, kUwJoints);      // encoffsets
  skip<float>(reader, 2 * 12);         // jac_vel, jac_f
  return true;
}

bool readBerkeley(ByteReader& reader, const std::string& name, ArmMeasurement& arm) {
  skip<std::uint8_t>(reader, 3);  // runlevel, sublevel, pedal_down
  reader.text();                  // master
  skip<std::uint8_t>(reader, 1);  // controller
  const auto arms = reader.number<std::uint32_t>();
  bool found = false;
  for (std::uint32_t a = 0; a < arms && reader.ok(); ++a) {
    const bool wanted = reader.text() == name;
    skip<std::uint8_t>(reader, 1);  // type
    readPose(reader);               // base_pose
    skip<std::uint8_t>(reader, 1);  // tool_type
    const Pose tool = readPose(reader);
    reader.number<float>();  // grasp
    readPose(reader);        // tool_set_point
    reader.number<float>();
    std::array<std::optional<double>, 9> joints;
    const auto count = reader.number<std::uint32_t>();
    for (std::uint32_t k = 0; k < count && reader.ok(); ++k) {
      const auto type = reader.number<std::uint16_t>();
      reader.number<std::int16_t>();  // state
      skip<std::int32_t>(reader, 2);  // encoder value and offset
      reader.number<std::int16_t>();  // dac_command
      const double position = static_cast<double>(reader.number<float>());
      skip<float>(reader, 5);          // velocity, motor, torque, gravity
      reader.number<std::uint8_t>();   // command
      skip<float>(reader, 1 + 1 + 4);  // value, integrated_position_error, set_point
      if (type < joints.size()) joints[type] = position;
    }
    skip<std::uint8_t>(reader, 2);  // pins
    if (!wanted || found) continue;
    found = true;
    arm.tool = tool;
    addJoints(joints, arm);
  }
  return found;
}

}  // namespace

std::optional<ArmMeasurement> readArmMeasurement(const std::string& md5sum,
                                                 const std::vector<std::uint8_t>& bytes,
                                                 const std::string& arm) {
  ByteReader reader(bytes);
  ArmMeasurement measurement;
  reader.number<std::uint32_t>();
  measurement.stamp = reader.time();
  measurement.frame = std::string(reader.text());
  bool found = false;
  if (md5sum == kUwState) {
    const auto index = uwIndexOf(arm);
    found = index && readUw(reader, *index, measurement);
  } else if (md5sum == kBerkeleyState) {
    found = readBerkeley(reader, arm, measurement);
  }
  if (!found || !reader.atEnd()) return std::nullopt;
  return measurement;
}

}  // namespace raven_correction
