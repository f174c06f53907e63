// SPDX-License-Identifier: BSD-3-Clause
// Poses and joints in the bytes of the state messages of both stacks, in micrometres and degrees or
// in metres and radians. The real definitions are held against in nodes/raven_state.py.
#include "raven_correction/ros/raven_state.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "raven_correction/geometry/rotation.h"
#include "support/raven_bytes.h"

namespace raven_correction {
namespace {

constexpr char kUw[] = "ce9e7f4969049d8bb365de3c98461a01";
constexpr char kBerkeley[] = "2489ec3d939b556c05d31ea2958841b2";

const Eigen::Quaterniond kGold = expRotation({0.3, -1.0, 0.2}), kGreen = expRotation({1.0, 0, 0.5});

/// A raven_2/raven_state whose arms differ in everything.
std::vector<std::uint8_t> uwState(bool mirrored = false) {
  Bytes bytes;
  bytes.header("").put<std::int32_t>(3).put<std::int32_t>(0).put<std::int32_t>(99);
  bytes.put<std::int32_t>(0).put<std::int32_t>(1);
  for (const std::int32_t micrometres : {-18071, -88820, -135347, 45000, 2, -170001})
    bytes.put(micrometres);
  for (const auto& q : {kGold, kGreen}) {
    Eigen::Matrix3d R = q.toRotationMatrix();
    if (mirrored) R.col(0) *= -1.0;
    for (int i = 0; i < 9; ++i) bytes.put(static_cast<float>(R(i / 3, i % 3)));
  }
  for (int i = 0; i < 18; ++i) bytes.put(-1.0f);                     // ori_d
  for (int i = 0; i < 6 + 2 + 32; ++i) bytes.put<std::int32_t>(-7);  // pos_d, dt, encVals, dac_val
  for (int i = 0; i < 32; ++i) bytes.put(-2.0f);                     // tau, mpos
  for (int i = 0; i < 16; ++i)  // jpos: every value times 180/pi, the insertion in metres included
    bytes.put(static_cast<float>((i % 8 == 2 ? -0.1 : 0.1 * (i + 1)) * 180.0 / M_PI));
  for (int i = 0; i < 64 + 2 + 16 + 24; ++i) bytes.put(-3.0f);
  return bytes.get();
}

void putPose(Bytes& bytes, double first) {
  for (int k = 0; k < 3; ++k) bytes.put(first + k);
  for (const double value : {0.5, -0.5, 0.5, 0.5}) bytes.put(value);
}

std::vector<std::uint8_t> berkeleyState() {
  Bytes bytes;
  bytes.header("/0_link").put<std::uint8_t>(3).put<std::uint8_t>(0).put<std::uint8_t>(1);
  bytes.put(std::string("planner")).put<std::uint8_t>(1).put<std::uint32_t>(2);
  for (const auto& [name, offset] : {std::pair{"L", 0.0}, std::pair{"R", 10.0}}) {
    bytes.put(std::string(name)).put<std::uint8_t>(0);
    putPose(bytes, -100.0);
    bytes.put<std::uint8_t>(1);
    putPose(bytes, 0.1 + offset);
    bytes.put(0.25f);
    putPose(bytes, -200.0);
    bytes.put(0.5f).put<std::uint32_t>(7);
    for (const std::uint16_t type : {0, 1, 2, 4, 5, 6, 7}) {
      bytes.put(type).put<std::int16_t>(4).put<std::int32_t>(1).put<std::int32_t>(2);
      bytes.put<std::int16_t>(3).put(static_cast<float>(0.1 * type + offset));
      for (int i = 0; i < 5; ++i) bytes.put(-1.0f);
      bytes.put<std::uint8_t>(1);
      for (int i = 0; i < 6; ++i) bytes.put(-1.0f);
    }
    bytes.put<std::uint8_t>(0).put<std::uint8_t>(0);
  }
  return bytes.get();
}

double joint(const ArmMeasurement& arm, const std::string& name) {
  for (std::size_t i = 0; i < arm.joint_names.size(); ++i)
    if (arm.joint_names[i] == name) return arm.positions[i];
  ADD_FAILURE() << "no joint " << name;
  return NAN;
}

TEST(RavenState, MicrometresAndDegreesBecomeMetresAndRadians) {
  for (const std::string name : {"gold", "left", "L"}) {
    const auto arm = readArmMeasurement(kUw, uwState(), name);
    ASSERT_TRUE(arm.has_value()) << name;
    EXPECT_EQ(arm->stamp, ros::Time(100, 500000000));
    EXPECT_EQ(arm->frame, "");
    EXPECT_LT((arm->tool.p - Eigen::Vector3d(-0.018071, -0.08882, -0.135347)).norm(), 1e-12);
    EXPECT_LT(rotationAngle(arm->tool.q, kGold), 1e-6);
    EXPECT_NEAR(joint(*arm, "shoulder"), 0.1, 1e-6);
    EXPECT_NEAR(joint(*arm, "elbow"), 0.2, 1e-6);
    EXPECT_NEAR(joint(*arm, "insertion"), -0.1, 1e-7);
    EXPECT_NEAR(joint(*arm, "tool_roll"), 0.5, 1e-6);
    EXPECT_NEAR(joint(*arm, "wrist_pitch"), 0.6, 1e-6);
    EXPECT_NEAR(joint(*arm, "wrist_yaw"), 0.5 * (0.8 - 0.7), 1e-6);
    EXPECT_EQ(arm->joint_names.size(), 8u);
  }
  const auto green = readArmMeasurement(kUw, uwState(), "green");
  ASSERT_TRUE(green.has_value());
  EXPECT_LT((green->tool.p - Eigen::Vector3d(0.045, 0.000002, -0.170001)).norm(), 1e-12);
  EXPECT_LT(rotationAngle(green->tool.q, kGreen), 1e-6);
  EXPECT_NEAR(joint(*green, "shoulder"), 0.9, 1e-6);
}

TEST(RavenState, AMatrixThatIsNoRotationIsNoPose) {
  const auto arm = readArmMeasurement(kUw, uwState(true), "gold");
  ASSERT_TRUE(arm.has_value());
  EXPECT_FALSE(hasUnitQuaternion(arm->tool));
}

TEST(RavenState, TheNamedArmOfTheBerkeleyStackIsRead) {
  const auto arm = readArmMeasurement(kBerkeley, berkeleyState(), "R");
  ASSERT_TRUE(arm.has_value());
  EXPECT_EQ(arm->frame, "/0_link");
  EXPECT_EQ(arm->tool.p, Eigen::Vector3d(10.1, 11.1, 12.1));
  EXPECT_EQ(arm->tool.q.y(), -0.5);
  EXPECT_NEAR(joint(*arm, "insertion"), 10.2, 1e-6);
  EXPECT_NEAR(joint(*arm, "wrist_yaw"), 0.05, 1e-6);
  EXPECT_FALSE(readArmMeasurement(kBerkeley, berkeleyState(), "M").has_value());
}

TEST(RavenState, AnotherTypeOrArmAndCutOrLongerBytesAreNothing) {
  EXPECT_FALSE(readArmMeasurement("d3812c3cbc69362b77dc0b19b345f8f5", uwState(), "L").has_value());
  EXPECT_FALSE(readArmMeasurement(kUw, uwState(), "middle").has_value());
  for (const auto& [md5sum, all] :
       {std::pair{kUw, uwState()}, std::pair{kBerkeley, berkeleyState()}}) {
    ASSERT_TRUE(readArmMeasurement(md5sum, all, "L").has_value());
    for (std::size_t size = 0; size < all.size(); ++size)
      EXPECT_FALSE(
          readArmMeasurement(md5sum, {all.begin(), all.begin() + static_cast<long>(size)}, "L")
              .has_value());
    std::vector<std::uint8_t> longer = all;
    longer.push_back(0);
    EXPECT_FALSE(readArmMeasurement(md5sum, longer, "L").has_value());
  }
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    std::vector<std::uint8_t> noise(random() % 1200);
    for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random());
    readArmMeasurement(kBerkeley, noise, "L");
    readArmMeasurement(kUw, noise, "L");
  }
}

}  // namespace
}  // namespace raven_correction
