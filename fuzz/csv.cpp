// SPDX-License-Identifier: BSD-3-Clause
// Fuzz target: CSV files, as tables of numbers, as pose streams and within a data set directory.
#include "raven_correction/dataset/csv.h"

#include "fuzz/fuzz_target.h"
#include "raven_correction/dataset/dataset_directory.h"

namespace raven_correction {
namespace fuzz {
namespace {

enum Reader : std::uint8_t {
  kTable,
  kLabelled,
  kStrictPoses,
  kAnyPoses,
  kPoseSet,
  kJointSet,
  kCount
};

/// A data set directory whose streams are the file in memory.
class DataSet {
 public:
  DataSet(const std::string& kind, const std::string& target)
      : folder_(std::filesystem::temp_directory_path() /
                ("raven_fuzz_" + std::to_string(getpid()) + "_" + kind)) {
    std::filesystem::create_directories(folder_);
    std::filesystem::create_symlink(target, folder_ / "stream.csv");
    std::ofstream(folder_ / "dataset.yaml")
        << "name: fuzz\nframe: 0_link\narm: raven2_left\nstreams:\n"
        << "  commands: {file: stream.csv, kind: " << kind << "}\n"
        << "  observations: {file: stream.csv, kind: " << kind << "}\n";
  }
  ~DataSet() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  DataSet(const DataSet&) = delete;
  DataSet& operator=(const DataSet&) = delete;
  void read() const { readDatasetDirectory(folder_.string()); }

 private:
  std::filesystem::path folder_;
};

}  // namespace

std::vector<Bytes> goodInputs() {
  const Bytes poses = bytesOf(
      "trajectory,stamp,x,y,z,qx,qy,qz,qw\na,0.0,0,0,0,0,0,0,1\na,0.02,0.001,0,0,0,0,0,1\n"
      "b,1.5,0.1,-0.2,0.3,0.5,0.5,0.5,0.5\n");
  const Bytes joints =
      bytesOf("trajectory,stamp,shoulder,elbow\na,0.0,0.1,1e-3\na,0.02,-0.1,0.2\nb,1,2,3\n");
  return {forReader(kTable, bytesOf("x,y\n1,2.5\n-3e-2, nan\r\n\n4,5\n")),
          forReader(kLabelled, joints),
          forReader(kStrictPoses, poses),
          forReader(kAnyPoses, poses),
          forReader(kPoseSet, poses),
          forReader(kJointSet, joints)};
}

void read(const Bytes& input) {
  if (input.empty()) return;
  static MemoryFile file;
  static const DataSet pose_set("pose", file.path()), joint_set("joint", file.path());
  file.set(input.data() + 1, input.size() - 1);
  switch (input[0] % kCount) {
    case kTable:
      readCsv(file.path(), "", CsvNumbers::kAny);
      break;
    case kLabelled:
      readCsv(file.path(), "trajectory");
      break;
    case kStrictPoses:
      readPoseCsv(file.path(), PoseChecks::kStrict);
      break;
    case kAnyPoses:
      readPoseCsv(file.path(), PoseChecks::kNone);
      break;
    case kPoseSet:
      pose_set.read();
      break;
    default:
      joint_set.read();
  }
}

}  // namespace fuzz
}  // namespace raven_correction
