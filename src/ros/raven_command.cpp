// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/raven_command.h"

namespace raven_correction {
namespace {

Pose readPose(ByteReader& reader) noexcept {
  double p[3], q[4];  // x y z, x y z w
  for (double& value : p) value = reader.number<double>();
  for (double& value : q) value = reader.number<double>();
  return {{p[0], p[1], p[2]}, {q[3], q[0], q[1], q[2]}};
}

bool namesDiffer(const RavenCommandContent& content) noexcept {
  for (std::size_t i = 0; i < content.arm_count; ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (content.arms[i].name == content.arms[j].name) return false;
  return true;
}

}  // namespace

bool readRavenCommand(const std::vector<std::uint8_t>& bytes,
                      RavenCommandContent& content) noexcept {
  ByteReader reader(bytes);
  reader.number<std::uint32_t>();  // header.seq
  content.stamp = reader.time();
  content.frame = reader.text();
  reader.text();  // source
  content.pedal_down = reader.flag();
  reader.number<std::uint8_t>();  // controller
  const auto names = reader.number<std::uint32_t>();
  if (names > RavenCommandContent::kMaxArms) return false;
  content.arm_count = names;
  for (std::size_t i = 0; i < names; ++i) content.arms[i].name = reader.text();
  if (reader.number<std::uint32_t>() != names) return false;
  for (std::size_t i = 0; i < names; ++i) {
    RavenArmCommand& arm = content.arms[i];
    arm.active = reader.flag();
    arm.pose_option = reader.number<std::uint8_t>();
    arm.place = reader.place();
    arm.pose = readPose(reader);
    reader.number<std::uint8_t>();                           // grasp_option
    reader.number<float>();                                  // grasp
    reader.skipArray(sizeof(std::uint16_t));                 // joint_types
    reader.skipArray(sizeof(std::uint8_t) + sizeof(float));  // joint_commands
  }
  return reader.atEnd() && namesDiffer(content);
}

void writeRavenPose(std::vector<std::uint8_t>& bytes, std::size_t place, const Pose& pose,
                    bool position, bool orientation) noexcept {
  const double p[3] = {pose.p.x(), pose.p.y(), pose.p.z()};
  const double q[4] = {pose.q.x(), pose.q.y(), pose.q.z(), pose.q.w()};
  if (position) std::memcpy(bytes.data() + place, p, sizeof p);
  if (orientation) std::memcpy(bytes.data() + place + sizeof p, q, sizeof q);
}

// As in rll/raven_2, raven_2_msgs/msg; constants, too, count for the md5 sum.
const char* RavenCommandType::definition() noexcept {
  return R"(Header header
string source
bool pedal_down
uint8 controller
string[] arm_names
ArmCommand[] arms

================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id

================================================================================
MSG: raven_2_msgs/ArmCommand
bool active
ToolCommand tool_command
uint16[] joint_types
JointCommand[] joint_commands

================================================================================
MSG: raven_2_msgs/ToolCommand
uint8 pose_option
uint8 POSE_OFF=0
uint8 POSE_ABSOLUTE=5
uint8 POSE_RELATIVE=15
uint8 POSE_POS_REL_ORI_ABS=7
uint8 POSE_POS_ABS_ORI_REL=13
uint8 POSE_POS_ABS_ORI_OFF=1
uint8 POSE_POS_OFF_ORI_ABS=4
uint8 POSE_POS_REL_ORI_OFF=3
uint8 POSE_POS_OFF_ORI_REL=12
uint8 POSE_OPTION_FLAG_POSITION_ENABLED=1
uint8 POSE_OPTION_FLAG_POSITION_RELATIVE=2
uint8 POSE_OPTION_FLAG_ORIENTATION_ENABLED=4
uint8 POSE_OPTION_FLAG_ORIENTATION_RELATIVE=8
string POSE_OPTION_STRINGS = OFF,POS_ABS_ORI_OFF,ERR2,POS_REL_ORI_OFF,POS_OFF_ORI_ABS,ABSOLUTE,ERR6,POS_REL_ORI_ABS,ERR8,ERR9,ERR10,ERR11,POS_OFF_ORI_REL,POS_ABS_ORI_REL,ERR14,RELATIVE
geometry_msgs/Pose pose
uint8 grasp_option
uint8 GRASP_OFF=0
uint8 GRASP_SET_NORMALIZED=1
uint8 GRASP_INCREMENT=2
uint8 GRASP_INCREMENT_SIGN=3
uint8 GRASP_SET_ANGLE=4
string GRASP_OPTION_STRINGS = OFF,SET_NORMALIZED,INCREMENT,INCREMENT_SIGN,SET_ANGLE
float32 grasp

================================================================================
MSG: geometry_msgs/Pose
Point position
Quaternion orientation

================================================================================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z

================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w

================================================================================
MSG: raven_2_msgs/JointCommand
uint8 command_type
float32 value
uint8 COMMAND_TYPE_NONE=0
uint8 COMMAND_TYPE_POSITION=1
uint8 COMMAND_TYPE_VELOCITY=2
uint8 COMMAND_TYPE_MOTOR_POSITION=3
uint8 COMMAND_TYPE_MOTOR_VELOCITY=4
uint8 COMMAND_TYPE_TORQUE=5
string COMMAND_TYPE_STRINGS = NONE,POSITION,VELOCITY,MOTOR_POSITION,MOTOR_VELOCITY,TORQUE
)";
}

}  // namespace raven_correction
