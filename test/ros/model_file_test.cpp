// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/model_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "raven_correction/correction/physics.h"
#include "raven_correction/correction/predictor.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/checked_stream.h"
#include "support/simple_model.h"
#include "support/temporary_directory.h"

namespace raven_correction {
namespace {

namespace fs = std::filesystem;

TEST(ModelFile, SurvivesARoundTripBitForBit) {
  const TemporaryDirectory folder;
  const std::string file = folder.path() + "/model.bag";
  for (const VelocityKind velocity :
       {VelocityKind::kNone, VelocityKind::kCausal, VelocityKind::kPast}) {
    Correction written = simpleModel(velocity);
    if (velocity == VelocityKind::kPast) {  // of a play instead of the third interval
      written.motion.intervals.pop_back();
      written.motion.play_length = 0.025;
      written.motion.play_angle = 0.4;
      written.motion.joint_play_length = 0.003;
      written.motion.joint_play_angle = 0.06;
      written.motion.joint_play_wrist = 0.07;
      std::ifstream robot("config/robots/raven2_left.yaml");
      written.motion.robot.assign(std::istreambuf_iterator<char>(robot), {});
    }
    written.homed_at = 900.5;
    written.speed_delay = 0.1171875;
    written.expires_at = 5000.25;
    writeModelFile(written, file, true);
    const Correction read = readModelFile(file);
    EXPECT_EQ(read.id, written.id);
    EXPECT_EQ(read.delay, written.delay);
    EXPECT_EQ(read.trained_at, written.trained_at);
    EXPECT_EQ(read.homed_at, written.homed_at);
    EXPECT_EQ(read.speed_delay, written.speed_delay);
    EXPECT_EQ(read.expires_at, written.expires_at);
    EXPECT_EQ(read.rigid.p, written.rigid.p);
    EXPECT_EQ(read.rigid.q.coeffs(), written.rigid.q.coeffs());
    EXPECT_EQ(read.mean_orientation.coeffs(), written.mean_orientation.coeffs());
    EXPECT_EQ(read.motion.intervals, written.motion.intervals);
    EXPECT_EQ(read.motion.play_length, written.motion.play_length);
    EXPECT_EQ(read.motion.play_angle, written.motion.play_angle);
    EXPECT_EQ(read.motion.robot, written.motion.robot);
    EXPECT_EQ(read.motion.joint_play_length, written.motion.joint_play_length);
    EXPECT_EQ(read.motion.joint_play_angle, written.motion.joint_play_angle);
    EXPECT_EQ(read.motion.joint_play_wrist, written.motion.joint_play_wrist);
    ASSERT_EQ(read.process.groups.size(), written.process.groups.size());
    for (std::size_t g = 0; g < read.process.groups.size(); ++g) {
      const GpGroup &a = read.process.groups[g], &b = written.process.groups[g];
      EXPECT_EQ(a.outputs, b.outputs);
      EXPECT_EQ(a.length_scales, b.length_scales);
      EXPECT_EQ(a.signal_variance, b.signal_variance);
      EXPECT_EQ(a.noise_variance, b.noise_variance);
      EXPECT_EQ(a.points, b.points);
      EXPECT_EQ(a.weights, b.weights);
      EXPECT_EQ(a.mean_weights, b.mean_weights);
      EXPECT_EQ(a.variance_factor, b.variance_factor);
    }
    // And so every prediction is the same to the last bit.
    const Predictor first(written), second(read);
    const auto workspace_a = first.makeWorkspace(), workspace_b = second.makeWorkspace();
    std::mt19937_64 random(3);
    for (int i = 0; i < 50; ++i) {
      Motion motion;
      motion.pose = {randomVector(random, 0.03), expRotation(randomVector(random, 0.2))};
      const Prediction a = first.predict(motion, *workspace_a);
      const Prediction b = second.predict(motion, *workspace_b);
      EXPECT_EQ(a.command.p, b.command.p);
      EXPECT_EQ(a.command.q.coeffs(), b.command.q.coeffs());
      EXPECT_EQ(a.sd_position, b.sd_position);
    }
  }
}

// A model with physics needs nothing but its file.
TEST(ModelFile, CarriesItsSimulation) {
  const TemporaryDirectory folder;
  const std::string file = folder.path() + "/model.bag";
  Correction written = simpleModel();
  written.physics.texts =
      simulationTexts(loadSimulationConfig("config/simulation/raven2_left_case2014.yaml"));
  written.physics.timing = {written.delay, 0.0093, 612.5};
  writeModelFile(written, file, false);
  const Correction read = readModelFile(file);
  EXPECT_EQ(read.physics.texts.simulation, written.physics.texts.simulation);
  EXPECT_EQ(read.physics.texts.robot, written.physics.texts.robot);
  EXPECT_EQ(read.physics.timing.delay, written.delay);
  EXPECT_EQ(read.physics.timing.hold, 0.0093);
  EXPECT_EQ(read.physics.timing.age, 612.5);
  const ToolPath path{{{{0.0, {{-0.02, -0.06, -0.14}, {0.5, -0.5, 0.5, 0.5}}}}}, 1};
  const InverseArm::Answer a = inverseArmOf(written.physics)->solve(path),
                           b = inverseArmOf(read.physics)->solve(path);
  ASSERT_TRUE(a.reached);
  EXPECT_EQ(a.command.p, b.command.p);
  written.physics = {};
  writeModelFile(written, file, true);
  EXPECT_TRUE(readModelFile(file).physics.empty());
}

TEST(ModelFile, NeverReplacesUnasked) {
  const TemporaryDirectory folder;
  const std::string file = folder.path() + "/model.bag";
  writeModelFile(simpleModel(), file, false);
  EXPECT_THROW(writeModelFile(simpleModel(), file, false), InvalidInput);
}

std::string complaint(const std::string& file) {
  try {
    readModelFile(file);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ModelFile, DamageIsNamed) {
  const TemporaryDirectory folder;
  const std::string file = folder.path() + "/model.bag";
  EXPECT_NE(complaint(file).find("no such file"), std::string::npos);
  writeModelFile(simpleModel(), file, false);
  fs::resize_file(file, fs::file_size(file) / 2);
  EXPECT_NE(complaint(file).find("cut off"), std::string::npos) << complaint(file);
  std::ofstream(file) << "not a bag";
  EXPECT_NE(complaint(file).find("not a complete bag"), std::string::npos) << complaint(file);
}

// A count that is damaged must not cost the memory that it asks for: roscpp would try.
TEST(ModelFile, DamagedBytesAreRefusedWhereverTheyAre) {
  Correction model;
  model.id = "small";
  model.inputs = {"a.bag", "b.bag"};
  CorrectionModel message = modelToMsg(model);
  message.groups.resize(2);
  message.groups[0].z.resize(4);
  message.groups[0].outputs.resize(3);
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  const CorrectionModel read = messageFromBytes<CorrectionModel>(bytes);
  EXPECT_EQ(read.id, "small");
  EXPECT_EQ(read.groups.size(), 2u);

  std::size_t refused = 0;
  for (std::size_t at = 0; at + 4 <= bytes.size(); ++at) {
    std::vector<std::uint8_t> damaged = bytes;
    std::fill_n(damaged.begin() + static_cast<std::ptrdiff_t>(at), 4, std::uint8_t{255});
    try {
      messageFromBytes<CorrectionModel>(damaged);
    } catch (const InvalidInput&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100u);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(messageFromBytes<CorrectionModel>(
                     {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}),
                 InvalidInput);
  bytes.push_back(0);
  EXPECT_THROW(messageFromBytes<CorrectionModel>(bytes), InvalidInput);
}

TEST(ModelFile, RefusesOtherFormatsAndSizes) {
  CorrectionModel msg = modelToMsg(simpleModel());
  msg.format = 99;
  EXPECT_THROW(modelFromMsg(msg), InvalidInput);
  msg = modelToMsg(simpleModel());
  msg.groups[0].alpha.pop_back();
  EXPECT_THROW(modelFromMsg(msg), InvalidInput);
  msg = modelToMsg(simpleModel());
  msg.groups[1].variance_factor.pop_back();
  EXPECT_THROW(modelFromMsg(msg), InvalidInput);
  msg = modelToMsg(simpleModel());
  msg.velocity = "fast";
  EXPECT_THROW(modelFromMsg(msg), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
