// SPDX-License-Identifier: BSD-3-Clause
// Inputs as users name them: bags, parts of bags and data set directories, as one data set.
#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>

#include "raven_correction/dataset/dataset_directory.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/names.h"
#include "raven_correction/ros/session_bag.h"
#include "raven_correction/ros/topics.h"
#include "session_parts.h"

namespace raven_correction {
namespace {

namespace fs = std::filesystem;

/// Parts NAME_0.bag, NAME_1.bag, ... of one recording together and by number, everything else
/// alone; in the order in which the first of each was given.
std::vector<std::vector<std::string>> groupParts(const std::vector<std::string>& paths) {
  static const std::regex kPart("(.*)_([0-9]+)\\.bag");
  std::vector<std::vector<std::string>> groups;
  std::map<std::string, std::size_t> group_of;
  for (const std::string& path : paths) {
    std::smatch match;
    if (!std::regex_match(path, match, kPart)) {
      groups.push_back({path});
      continue;
    }
    const auto [place, is_new] = group_of.emplace(match[1].str(), groups.size());
    if (is_new) groups.emplace_back();
    groups[place->second].push_back(path);
  }
  // The recorder writes numbers without leading zeros: the longer name is the later part.
  for (std::vector<std::string>& group : groups)
    std::sort(group.begin(), group.end(), [](const std::string& a, const std::string& b) {
      return a.size() != b.size() ? a.size() < b.size() : a < b;
    });
  return groups;
}

}  // namespace

Dataset readInput(const std::string& path) {
  if (fs::is_directory(path)) return readDatasetDirectory(path);
  if (!fs::exists(path))
    throw InvalidInput(
        format("%s: neither a bag nor a data set directory; is the name right?", path.c_str()));
  return readSessionBag(path).dataset;
}

std::vector<std::string> inputsNamed(const std::vector<std::string>& names,
                                     const std::string& directory) {
  std::vector<std::string> inputs;
  for (const std::string& name : names) {
    const std::string path = expandHome(name);
    inputs.push_back(fs::path(path).is_relative() && !fs::exists(path)
                         ? (fs::path(directory) / path).string()
                         : path);
  }
  if (!inputs.empty()) return inputs;
  if (fs::is_directory(directory))
    for (const auto& entry : fs::directory_iterator(directory))
      if (entry.path().extension() == ".bag" && holdsSession(entry.path().string()))
        inputs.push_back(entry.path().string());
  if (inputs.empty())
    throw InvalidInput(format("no bag in %s; record a session first, or name the bags in the call",
                              directory.c_str()));
  std::sort(inputs.begin(), inputs.end());
  return inputs;
}

namespace {

/// All inputs as one session without goals.
Session readSessions(const std::vector<std::string>& paths, const ShareRead& progress) {
  if (paths.empty()) throw InvalidInput("no input; give bags or data set directories");
  const std::vector<std::vector<std::string>> groups = groupParts(paths);
  const auto read = [&](std::size_t i) {
    const std::vector<std::string>& group = groups[i];
    if (group.size() > 1 || fs::is_regular_file(group.front()))
      return readSessionParts(group, partOf(progress, i, groups.size()));
    Session session;
    session.dataset = readInput(group.front());
    return session;
  };
  Session all = read(0);
  for (std::size_t i = 1; i < groups.size(); ++i) {
    Session next = read(i);
    Dataset& more = next.dataset;
    if (more.frame != all.dataset.frame)
      throw InvalidInput(format("%s: poses are in frame \"%s\", those of %s in \"%s\"",
                                more.source.c_str(), more.frame.c_str(), all.dataset.source.c_str(),
                                all.dataset.frame.c_str()));
    all.dataset.source += ", " + more.source;
    all.homed_at.insert(all.homed_at.end(), next.homed_at.begin(), next.homed_at.end());
    std::set<std::string> known;
    for (const Trajectory& trajectory : all.dataset.trajectories) known.insert(trajectory.id);
    for (Trajectory& trajectory : more.trajectories) {
      if (known.count(trajectory.id)) trajectory.id = more.name + "/" + trajectory.id;
      all.dataset.trajectories.push_back(std::move(trajectory));
    }
  }
  sortByStart(all.dataset);
  std::sort(all.homed_at.begin(), all.homed_at.end());
  return all;
}

}  // namespace

Dataset readInputs(const std::vector<std::string>& paths, const ShareRead& progress) {
  return readSessions(paths, progress).dataset;
}

CheckedInputs readCheckedInputs(const std::vector<std::string>& paths,
                                const std::vector<ArmKinematics>& arms, const ShareRead& progress) {
  Session all = readSessions(paths, progress);
  CheckedInputs inputs;
  StreamCheckOptions options;
  options.arms = arms;
  inputs.findings = checkDataset(all.dataset, options);
  const std::vector<Trajectory>& trajectories = all.dataset.trajectories;  // by start
  // The one that what is learnt from came after; those that followed have made it out of date.
  for (const double homed : all.homed_at)
    if (!trajectories.empty() && homed <= trajectories.back().start()) inputs.homed_at = homed;
  const double last = all.homed_at.empty() ? 0.0 : all.homed_at.back();
  std::size_t before = 0;
  for (const Trajectory& trajectory : trajectories) before += trajectory.start() < last ? 1 : 0;
  if (before > 0)
    inputs.findings.push_back(
        {StreamFinding::Severity::kWarning, topics::kRobotHomed, "homing",
         format(
             "the robot was homed, or may have been while its state was silent, after %zu of %zu "
             "trajectories",
             before, trajectories.size()),
         "one homing for all that is learnt from, and none after it",
         before < trajectories.size()
             ? "each homing leaves other offsets: leave out what was recorded before the last one"
             : "each homing leaves other offsets: a model of this is out of date, record again"});
  inputs.dataset = std::move(all.dataset);
  return inputs;
}

}  // namespace raven_correction
