// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/dataset/dataset_directory.h"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "raven_correction/dataset/csv.h"
#include "raven_correction/error.h"

namespace raven_correction {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kPoseColumns = {"stamp", "x", "y", "z", "qx", "qy", "qz", "qw"};
constexpr char kLabelColumn[] = "trajectory";

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}

/// Rows of one trajectory must be neighbours, and their stamps must not go back.
void checkOrder(const CsvTable& table) {
  std::set<std::string> finished;
  for (std::size_t i = 1; i < table.labels.size(); ++i) {
    const Eigen::Index row = static_cast<Eigen::Index>(i);
    if (table.labels[i] != table.labels[i - 1]) {
      finished.insert(table.labels[i - 1]);
      if (finished.count(table.labels[i]))
        throw InvalidInput(
            format("%s:%zu: trajectory %s goes on after another one began; keep its rows together",
                   table.file.c_str(), table.lines[i], table.labels[i].c_str()));
    } else if (table.values(row, 0) < table.values(row - 1, 0)) {
      throw InvalidInput(format(
          "%s:%zu: stamp %.6f is %.6f s before the row above; sort the rows of trajectory %s",
          table.file.c_str(), table.lines[i], table.values(row, 0),
          table.values(row - 1, 0) - table.values(row, 0), table.labels[i].c_str()));
    }
  }
}

StampedPose poseOfRow(const CsvTable& table, std::size_t i, PoseChecks checks) {
  const auto row = table.values.row(static_cast<Eigen::Index>(i));
  StampedPose sample;
  sample.stamp = row(0);
  sample.pose.p = {row(1), row(2), row(3)};
  sample.pose.q.coeffs() << row(4), row(5), row(6), row(7);
  if (checks == PoseChecks::kNone) return sample;
  if (!hasUnitQuaternion(sample.pose))
    throw InvalidInput(format(
        "%s:%zu: quaternion (%g, %g, %g, %g) has length %.6f, must be 1 within %g; is the order "
        "x,y,z,w, or is a number missing?",
        table.file.c_str(), table.lines[i], row(4), row(5), row(6), row(7), sample.pose.q.norm(),
        kUnitTolerance));
  sample.pose.q.normalize();
  return sample;
}

/// The trajectory of that name, made where it is new.
Trajectory& trajectoryOf(const std::string& id, std::map<std::string, std::size_t>& index,
                         Dataset& dataset) {
  const auto [place, is_new] = index.emplace(id, dataset.trajectories.size());
  if (is_new) {
    dataset.trajectories.emplace_back();
    dataset.trajectories.back().id = id;
  }
  return dataset.trajectories[place->second];
}

std::map<std::string, JointStream> readJointCsv(const std::string& file) {
  const CsvTable table = readCsv(file, kLabelColumn);
  if (table.columns.size() < 2 || table.columns.front() != "stamp")
    throw InvalidInput(format("%s:1: columns are %s; expected trajectory,stamp,<joints...>",
                              file.c_str(), join(table.columns).c_str()));
  checkOrder(table);
  std::map<std::string, JointStream> streams;
  for (std::size_t i = 0; i < table.labels.size(); ++i) {
    JointStream& stream = streams[table.labels[i]];
    stream.names.assign(table.columns.begin() + 1, table.columns.end());
    const auto row = table.values.row(static_cast<Eigen::Index>(i));
    stream.samples.push_back({row(0), row.tail(row.size() - 1).transpose()});
  }
  return streams;
}

PoseStream* poseStreamNamed(const std::string& name, Trajectory& trajectory) {
  if (name == "commands") return &trajectory.commands;
  if (name == "observations") return &trajectory.observations;
  if (name == "encoders") return &trajectory.encoders;
  return nullptr;
}

JointStream* jointStreamNamed(const std::string& name, Trajectory& trajectory) {
  if (name == "commands") return &trajectory.joint_commands;
  if (name == "observations") return &trajectory.joint_observations;
  return nullptr;
}

YAML::Node loadYaml(const std::string& file) {
  try {
    return YAML::LoadFile(file);
  } catch (const YAML::BadFile&) {
    throw InvalidInput(
        format("%s: cannot be read; a data set directory holds a dataset.yaml", file.c_str()));
  } catch (const YAML::Exception& error) {
    throw InvalidInput(format("%s: %s", file.c_str(), error.what()));
  }
}

/// What a map has under the key if that is a scalar; node must be a map.
std::string text(const YAML::Node& node, const char* key, const std::string& otherwise) {
  return node[key] && node[key].IsScalar() ? node[key].as<std::string>() : otherwise;
}

/// One line below streams: name: {file: ..., kind: pose or joint}.
struct StreamEntry {
  std::string name, kind, file;
};

StreamEntry readStreamEntry(const YAML::Node& name, const YAML::Node& value,
                            const std::string& yaml_file) {
  if (!name.IsScalar() || !value.IsMap())
    throw InvalidInput(format("%s:%d: stream \"%s\" must be {file: ..., kind: pose or joint}",
                              yaml_file.c_str(), name.Mark().line + 1,
                              name.IsScalar() ? name.Scalar().c_str() : ""));
  return {name.Scalar(), text(value, "kind", ""), text(value, "file", "")};
}

/// joints: [{name: X, unit: rad|m}], which joint streams need to be understood without a robot.
std::map<std::string, std::string> readJointUnits(const YAML::Node& yaml, const std::string& file) {
  std::map<std::string, std::string> units;
  if (!yaml["joints"]) return units;
  if (!yaml["joints"].IsSequence())
    throw InvalidInput(
        format("%s: joints must be a list of {name: ..., unit: rad or m}", file.c_str()));
  for (const YAML::Node& joint : yaml["joints"]) {
    const std::string name = joint.IsMap() ? text(joint, "name", "") : "";
    const std::string unit = joint.IsMap() ? text(joint, "unit", "") : "";
    if (name.empty() || (unit != "rad" && unit != "m"))
      throw InvalidInput(
          format("%s: joint \"%s\" has the unit \"%s\", must have a name and rad or m",
                 file.c_str(), name.c_str(), unit.c_str()));
    units[name] = unit;
  }
  return units;
}

}  // namespace

std::vector<NamedPoseStream> readPoseCsv(const std::string& file, PoseChecks checks) {
  const CsvTable table = readCsv(
      file, kLabelColumn, checks == PoseChecks::kStrict ? CsvNumbers::kFinite : CsvNumbers::kAny);
  if (table.columns != kPoseColumns)
    throw InvalidInput(format("%s:1: columns are %s,%s; expected %s,%s", file.c_str(), kLabelColumn,
                              join(table.columns).c_str(), kLabelColumn,
                              join(kPoseColumns).c_str()));
  if (checks == PoseChecks::kStrict) checkOrder(table);
  std::vector<NamedPoseStream> streams;
  for (std::size_t i = 0; i < table.labels.size(); ++i) {
    if (streams.empty() || streams.back().trajectory != table.labels[i])
      streams.push_back({table.labels[i], {}, {}});
    streams.back().samples.push_back(poseOfRow(table, i, checks));
    streams.back().lines.push_back(table.lines[i]);
  }
  return streams;
}

Dataset readDatasetDirectory(const std::string& directory) {
  const std::string yaml_file = (fs::path(directory) / "dataset.yaml").string();
  const YAML::Node yaml = loadYaml(yaml_file);
  if (!yaml.IsMap() || !yaml["streams"] || !yaml["streams"].IsMap() || yaml["streams"].size() == 0)
    throw InvalidInput(
        format("%s: no streams; expected streams: {commands: {file: ..., kind: "
               "pose}, observations: {...}}",
               yaml_file.c_str()));
  Dataset dataset;
  dataset.source = directory;
  dataset.name = text(yaml, "name", fs::path(directory).filename().string());
  dataset.description = text(yaml, "description", "");
  dataset.frame = text(yaml, "frame", "base");
  dataset.arm = text(yaml, "arm", "");
  dataset.joint_units = readJointUnits(yaml, yaml_file);
  std::map<std::string, std::size_t> index;
  for (const auto& entry : yaml["streams"]) {
    const auto [name, kind, file_name] = readStreamEntry(entry.first, entry.second, yaml_file);
    const std::string file = (fs::path(directory) / file_name).string();
    Trajectory known;
    if (kind == "pose" && poseStreamNamed(name, known)) {
      for (NamedPoseStream& stream : readPoseCsv(file, PoseChecks::kStrict))
        *poseStreamNamed(name, trajectoryOf(stream.trajectory, index, dataset)) =
            std::move(stream.samples);
    } else if (kind == "joint" && jointStreamNamed(name, known)) {
      for (auto& [id, stream] : readJointCsv(file))
        *jointStreamNamed(name, trajectoryOf(id, index, dataset)) = std::move(stream);
    } else {
      throw InvalidInput(
          format("%s: stream \"%s\" of kind \"%s\" is not known; streams are "
                 "commands, observations (pose or joint) and encoders (pose)",
                 yaml_file.c_str(), name.c_str(), kind.c_str()));
    }
  }
  sortByStart(dataset);
  return dataset;
}

namespace {

/// A file that complains when it cannot be written to the end (disk full).
class CsvWriter {
 public:
  CsvWriter(const fs::path& file, const std::string& header) : file_(file.string()), out_(file) {
    out_ << header << '\n';
  }
  void row(const std::string& trajectory, double stamp, const double* values, std::size_t count) {
    out_ << trajectory << format(",%.9f", stamp);
    for (std::size_t k = 0; k < count; ++k) out_ << format(",%.17g", values[k]);
    out_ << '\n';
  }
  void close() {
    out_.close();
    if (!out_)
      throw InvalidInput(format("%s: cannot be written; is the disk full?", file_.c_str()));
  }

 private:
  std::string file_;
  std::ofstream out_;
};

void writePoseStream(const Dataset& dataset, const fs::path& file, PoseStream Trajectory::*stream) {
  CsvWriter writer(file, std::string(kLabelColumn) + "," + join(kPoseColumns));
  for (const Trajectory& trajectory : dataset.trajectories)
    for (const StampedPose& sample : trajectory.*stream) {
      const Eigen::Vector3d& p = sample.pose.p;
      const Eigen::Quaterniond& q = sample.pose.q;
      const double values[] = {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
      writer.row(trajectory.id, sample.stamp, values, 7);
    }
  writer.close();
}

void writeJointStream(const Dataset& dataset, const fs::path& file, JointStream Trajectory::*stream,
                      const std::vector<std::string>& names) {
  CsvWriter writer(file, std::string(kLabelColumn) + ",stamp," + join(names));
  for (const Trajectory& trajectory : dataset.trajectories)
    for (const StampedJoints& sample : (trajectory.*stream).samples)
      writer.row(trajectory.id, sample.stamp, sample.positions.data(),
                 static_cast<std::size_t>(sample.positions.size()));
  writer.close();
}

}  // namespace

void writeDatasetDirectory(const Dataset& dataset, const std::string& directory) {
  std::error_code error;
  fs::create_directories(directory, error);
  if (error || !fs::is_directory(directory))
    throw InvalidInput(
        format("%s: cannot be made a directory: %s", directory.c_str(), error.message().c_str()));
  if (!fs::is_empty(directory))
    throw InvalidInput(
        format("%s: exists and is not empty; nothing was written, choose another "
               "name or remove it first",
               directory.c_str()));
  YAML::Node yaml;
  yaml["name"] = dataset.name;
  yaml["description"] = dataset.description;
  yaml["frame"] = dataset.frame;
  yaml["arm"] = dataset.arm;
  for (const auto& [joint, unit] : dataset.joint_units) {
    YAML::Node entry;
    entry["name"] = joint;
    entry["unit"] = unit;
    yaml["joints"].push_back(entry);
  }
  const std::pair<const char*, PoseStream Trajectory::*> pose_streams[] = {
      {"commands", &Trajectory::commands},
      {"observations", &Trajectory::observations},
      {"encoders", &Trajectory::encoders}};
  const std::pair<const char*, JointStream Trajectory::*> joint_streams[] = {
      {"commands", &Trajectory::joint_commands}, {"observations", &Trajectory::joint_observations}};
  for (const auto& [name, stream] : pose_streams) {
    bool any = false;
    for (const Trajectory& trajectory : dataset.trajectories) any |= !(trajectory.*stream).empty();
    if (!any) continue;
    yaml["streams"][name]["file"] = std::string(name) + ".csv";
    yaml["streams"][name]["kind"] = "pose";
    writePoseStream(dataset, fs::path(directory) / (std::string(name) + ".csv"), stream);
  }
  for (const auto& [name, stream] : joint_streams) {
    std::vector<std::string> names;
    for (const Trajectory& trajectory : dataset.trajectories)
      if (!(trajectory.*stream).samples.empty()) names = (trajectory.*stream).names;
    if (names.empty() || yaml["streams"][name]) continue;
    yaml["streams"][name]["file"] = std::string(name) + ".csv";
    yaml["streams"][name]["kind"] = "joint";
    writeJointStream(dataset, fs::path(directory) / (std::string(name) + ".csv"), stream, names);
  }
  std::ofstream out(fs::path(directory) / "dataset.yaml");
  out << yaml << '\n';
  out.close();
  if (!out)
    throw InvalidInput(format("%s: cannot be written; is the disk full?", directory.c_str()));
}

}  // namespace raven_correction
