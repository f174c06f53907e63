// SPDX-License-Identifier: BSD-3-Clause
// Fuzz target: the model of the correction, as a message and as a file, up to the first pose that a
// corrector answers with it.
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <random>

#include "fuzz/fuzz_target.h"
#include "raven_correction/correction/corrector.h"
#include "raven_correction/ros/checked_stream.h"
#include "raven_correction/ros/model_file.h"

namespace raven_correction {
namespace fuzz {
namespace {

/// Small, with every part filled in.
Correction smallModel(bool physical) {
  Correction model;
  model.id = "fuzz";
  model.frame = "0_link";
  model.arm = "raven2_left";
  model.inputs = {"a.bag", "b.bag"};
  model.delay = 0.1;
  model.motion.velocity = VelocityKind::kCausal;
  model.trust.workspace_min.setConstant(-0.1);
  model.trust.workspace_max.setConstant(0.1);
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const auto features = static_cast<Eigen::Index>(featureCount(model.motion));
  Eigen::MatrixXd x(12, features), y(12, 6);
  for (double& value : x.reshaped()) value = normal(random);
  for (double& value : y.reshaped()) value = 0.01 * normal(random);
  GpConfig config;
  config.max_hyper_points = 10;
  config.inducing_points = 5;
  config.groups = {{0, 1, 2}, {3, 4, 5}};
  model.process = fitGp(x, y, config).model;
  if (physical) {
    model.physics.texts = simulationTexts(
        loadSimulationConfig((configFolder() / "simulation/raven2_left_case2014.yaml").string()));
    model.physics.timing = {model.delay, 0.01, 100.0};
  }
  return model;
}

/// A bag again, with its chunks compressed.
Bytes packed(const std::string& path, rosbag::compression::CompressionType compression) {
  const std::string copy = path + ".packed";
  {
    const rosbag::Bag bag(path);
    rosbag::Bag to(copy, rosbag::bagmode::Write);
    to.setCompression(compression);
    for (const rosbag::MessageInstance& instance : rosbag::View(bag))
      to.write(instance.getTopic(), instance.getTime(), instance);
  }
  const Bytes bytes = contentOf(copy);
  std::filesystem::remove(copy);
  return bytes;
}

/// Whatever was taken must answer, and never with a number that is none.
void use(const Correction& model) {
  Corrector corrector(CorrectorLimits{});
  corrector.setModel(model);
  corrector.setMode(CorrectorMode::kFull);
  for (int i = 0; i < 3; ++i) {
    const double stamp = 100.0 + 0.01 * i;
    const Pose desired{{0.01 * i, 0.0, -0.01}, expRotation({0.1, 0.0, 0.01 * i})};
    const CorrectorOutput output = corrector.correct(stamp, stamp, desired, false);
    if (isRefused(output.code) || !isFinite(output.command) || !hasUnitQuaternion(output.command))
      throw std::logic_error("a good pose was not answered with a pose");
  }
}

}  // namespace

std::vector<Bytes> goodInputs() {
  std::vector<Bytes> inputs;
  for (const bool physical : {false, true}) {
    const Correction model = smallModel(physical);
    inputs.push_back(forReader(0, serialised(modelToMsg(model))));
    const std::string path =
        (std::filesystem::temp_directory_path() / ("raven_fuzz_" + std::to_string(getpid())))
            .string();
    writeModelFile(model, path, true);
    inputs.push_back(forReader(1, contentOf(path)));
    for (const auto compression : {rosbag::compression::BZ2, rosbag::compression::LZ4})
      inputs.push_back(forReader(1, packed(path, compression)));
    std::filesystem::remove(path);
  }
  return inputs;
}

void read(const Bytes& input) {
  if (input.empty()) return;
  if (input[0] % 2 == 0) {
    use(modelFromMsg(messageFromBytes<CorrectionModel>({input.begin() + 1, input.end()})));
  } else {
    static MemoryFile file;
    file.set(input.data() + 1, input.size() - 1);
    use(readModelFile(file.path()));
  }
}

}  // namespace fuzz
}  // namespace raven_correction
