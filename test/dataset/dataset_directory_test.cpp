// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/dataset/dataset_directory.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "raven_correction/error.h"
#include "support/random_poses.h"
#include "support/temporary_directory.h"

namespace raven_correction {
namespace {

namespace fs = std::filesystem;

Dataset sample() {
  std::mt19937_64 random(1);
  Dataset dataset;
  dataset.name = "sample";
  dataset.frame = "0_link";
  for (int k = 0; k < 3; ++k) {
    Trajectory trajectory;
    trajectory.id = "t" + std::to_string(k);
    for (int i = 0; i < 5; ++i) {
      trajectory.commands.push_back({10.0 * k + 0.1 * i, randomPose(random)});
      trajectory.observations.push_back({10.0 * k + 0.1 * i + 0.03, randomPose(random)});
    }
    dataset.trajectories.push_back(trajectory);
  }
  return dataset;
}

TEST(DatasetDirectory, SurvivesARoundTrip) {
  const TemporaryDirectory folder;
  const std::string path = folder.path() + "/set";
  const Dataset written = sample();
  writeDatasetDirectory(written, path);
  const Dataset read = readDatasetDirectory(path);
  ASSERT_EQ(read.trajectories.size(), written.trajectories.size());
  EXPECT_EQ(read.frame, "0_link");
  for (std::size_t k = 0; k < read.trajectories.size(); ++k) {
    EXPECT_EQ(read.trajectories[k].id, written.trajectories[k].id);
    ASSERT_EQ(read.trajectories[k].observations.size(), 5u);
    for (std::size_t i = 0; i < 5; ++i) {
      const StampedPose& a = read.trajectories[k].observations[i];
      const StampedPose& b = written.trajectories[k].observations[i];
      EXPECT_NEAR(a.stamp, b.stamp, 1e-9);
      EXPECT_EQ(a.pose.p, b.pose.p);
      EXPECT_LT(rotationAngle(a.pose.q, b.pose.q), 1e-15);
    }
  }
  EXPECT_THROW(writeDatasetDirectory(written, path), InvalidInput);  // never overwrites
}

/// Writes a good data set, lets `spoil` change commands.csv, and returns the error text.
std::string complaint(const std::function<void(std::string&)>& spoil) {
  const TemporaryDirectory folder;
  const std::string path = folder.path() + "/set";
  writeDatasetDirectory(sample(), path);
  std::ifstream in(path + "/commands.csv");
  std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  spoil(text);
  std::ofstream(path + "/commands.csv") << text;
  try {
    readDatasetDirectory(path);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

std::string line(const std::string& text, int number) {
  std::istringstream stream(text);
  std::string result;
  for (int i = 0; i < number; ++i) std::getline(stream, result);
  return result;
}

void replaceLine(std::string& text, int number, const std::string& with) {
  const std::string old = line(text, number);
  text.replace(text.find(old), old.size(), with);
}

void expectComplaint(const std::string& text, const std::string& place, const std::string& what) {
  EXPECT_NE(text.find(place), std::string::npos) << text;
  EXPECT_NE(text.find(what), std::string::npos) << text;
}

TEST(DatasetDirectory, BadInputIsNamedWithFileAndLine) {
  expectComplaint(complaint([](std::string& t) { replaceLine(t, 1, "trajectory,stamp,x,y,z"); }),
                  "commands.csv:", "");
  expectComplaint(
      complaint([](std::string& t) { replaceLine(t, 1, "trajectory,time,x,y,z,qx,qy,qz,qw"); }),
      "commands.csv:1", "expected trajectory,stamp");
  expectComplaint(complaint([](std::string& t) { replaceLine(t, 3, "t0,0.1,nan,0,0,0,0,0,1"); }),
                  "commands.csv:3", "column x is nan");
  expectComplaint(complaint([](std::string& t) { replaceLine(t, 3, "t0,0.1,zero,0,0,0,0,0,1"); }),
                  "commands.csv:3", "\"zero\" is not a number");
  expectComplaint(complaint([](std::string& t) { replaceLine(t, 3, "t0,0.1,0,0"); }),
                  "commands.csv:3", "4 fields");
  expectComplaint(complaint([](std::string& t) { replaceLine(t, 3, "t0,0.1,0,0,0,0,0,0.5,1"); }),
                  "commands.csv:3", "quaternion");
  expectComplaint(complaint([](std::string& t) { replaceLine(t, 4, "t0,0.05,0,0,0,0,0,0,1"); }),
                  "commands.csv:4", "before the row above");
  expectComplaint(complaint([](std::string& t) { t += "t0,99,0,0,0,0,0,0,1\n"; }),
                  "commands.csv:17", "goes on after another one");
  expectComplaint(complaint([](std::string& t) { t = line(t, 1) + "\n"; }), "commands.csv",
                  "no row");
}

TEST(DatasetDirectory, AStreamThatIsNoMapIsNamedWithItsLine) {
  const TemporaryDirectory folder;
  const std::pair<const char*, const char*> streams[] = {
      {"commands: commands.csv", "stream \"commands\" must be {file: ..., kind: pose or joint}"},
      {"commands:", "stream \"commands\" must be"},
      {"commands: [commands.csv, pose]", "stream \"commands\" must be"},
      {"? [commands]\n  : {file: commands.csv, kind: pose}", "stream \"\" must be"}};
  for (const auto& [stream, what] : streams) {
    std::ofstream(folder.path() + "/dataset.yaml") << "name: s\nstreams:\n  " << stream << "\n";
    try {
      readDatasetDirectory(folder.path());
      ADD_FAILURE() << stream;
    } catch (const InvalidInput& error) {
      expectComplaint(error.what(), "dataset.yaml:3", what);
    }
  }
}

TEST(DatasetDirectory, MissingFilesAreNamed) {
  const TemporaryDirectory folder;
  EXPECT_THROW(readDatasetDirectory(folder.path()), InvalidInput);
  const std::string path = folder.path() + "/set";
  writeDatasetDirectory(sample(), path);
  fs::remove(path + "/observations.csv");
  try {
    readDatasetDirectory(path);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("observations.csv"), std::string::npos);
  }
}

}  // namespace
}  // namespace raven_correction
