// SPDX-License-Identifier: BSD-3-Clause
// Fuzz target: every YAML file of the package: robots, simulations, trainer configurations and data
// sets.
#include "fuzz/fuzz_target.h"
#include "raven_correction/correction/training_config.h"
#include "raven_correction/dataset/dataset_directory.h"
#include "raven_correction/robot/chain_file.h"
#include "raven_correction/simulation/simulation_config.h"

namespace raven_correction {
namespace fuzz {
namespace {

enum Reader : std::uint8_t { kRobot, kSimulation, kTraining, kDataSet, kCount };

/// A folder whose dataset.yaml is the file in memory.
std::string dataSetFolder(const std::string& target) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("raven_fuzz_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::filesystem::create_symlink(target, folder / "dataset.yaml");
  std::ofstream(folder / "c.csv") << "trajectory,stamp,x,y,z,qx,qy,qz,qw\na,0.0,0,0,0,0,0,0,1\n";
  static std::string to_remove;
  to_remove = folder.string();
  std::atexit([] {
    std::error_code ignored;
    std::filesystem::remove_all(to_remove, ignored);
  });
  return folder.string();
}

}  // namespace

std::vector<Bytes> goodInputs() {
  std::vector<Bytes> inputs;
  const auto add = [&](Reader reader, const std::filesystem::path& folder) {
    for (const auto& entry : std::filesystem::directory_iterator(configFolder() / folder))
      if (entry.path().extension() == ".yaml")
        inputs.push_back(forReader(reader, contentOf(entry.path())));
  };
  add(kRobot, "robots");
  add(kSimulation, "simulation");
  for (const char* const file : {"trainer.yaml", "trainer_case2014.yaml"})
    inputs.push_back(forReader(kTraining, contentOf(configFolder() / file)));
  inputs.push_back(
      forReader(kDataSet, bytesOf("name: s\nframe: 0_link\narm: raven2_left\nstreams:\n"
                                  "  commands: {file: c.csv, kind: pose}\n"
                                  "  observations: {file: c.csv, kind: pose}\n")));
  return inputs;
}

void read(const Bytes& input) {
  if (input.empty()) return;
  static MemoryFile file;
  static const std::string data_set = dataSetFolder(file.path());
  static const std::string robot = textOf(contentOf(configFolder() / "robots/raven2_left.yaml"));
  const std::string text(input.begin() + 1, input.end());
  switch (input[0] % kCount) {
    case kRobot:
      kinematicChainFromText(text, "fuzz");
      break;
    case kSimulation:
      simulationFromTexts({text, robot}, "fuzz");
      break;
    case kTraining:
      file.set(input.data() + 1, input.size() - 1);
      loadTrainingConfig(file.path());
      break;
    default:
      file.set(input.data() + 1, input.size() - 1);
      readDatasetDirectory(data_set);
  }
}

}  // namespace fuzz
}  // namespace raven_correction
