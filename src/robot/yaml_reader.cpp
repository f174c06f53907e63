// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/robot/yaml_reader.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// Number of single-character changes between two words (Levenshtein).
std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

}  // namespace

struct YamlReader::File {
  std::string path;
  std::vector<std::string> problems;
};

struct YamlReader::Node {
  YAML::Node yaml;
};

YamlReader::YamlReader(std::shared_ptr<File> file, std::shared_ptr<const Node> node,
                       std::string place)
    : file_(std::move(file)), node_(std::move(node)), place_(std::move(place)) {}

YamlReader YamlReader::fromFile(const std::string& path) {
  std::ifstream stream(path);
  std::ostringstream text;
  if (stream) text << stream.rdbuf();
  if (!stream) throw InvalidInput(format("%s: no such file, or not readable", path.c_str()));
  return fromText(text.str(), path);
}

YamlReader YamlReader::fromText(const std::string& text, const std::string& name) {
  YAML::Node root;
  try {
    root = YAML::Load(text);
  } catch (const YAML::ParserException& error) {
    throw InvalidInput(format("%s: line %d is not YAML: %s", name.c_str(), error.mark.line + 1,
                              error.msg.c_str()));
  }
  if (!root.IsMap())
    throw InvalidInput(format("%s: must be a YAML mapping (`key: value` lines)", name.c_str()));
  auto file = std::make_shared<File>();
  file->path = name;
  return YamlReader(file, std::make_shared<Node>(Node{root}), "");
}

bool YamlReader::has(const std::string& key) const {
  return node_->yaml.IsMap() && node_->yaml[key].IsDefined();
}

std::vector<std::string> YamlReader::keys() const {
  std::vector<std::string> names;
  if (!node_->yaml.IsMap()) return names;
  for (const auto& entry : node_->yaml) names.push_back(entry.first.as<std::string>("?"));
  return names;
}

void YamlReader::problem(const std::string& key, const std::string& text) {
  const std::string place = place_.empty() ? key : (key.empty() ? place_ : place_ + "." + key);
  file_->problems.push_back(place + ": " + text);
}

void YamlReader::know(const std::string& key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.push_back(key);
}

bool YamlReader::require(const std::string& key) {
  know(key);
  if (has(key)) return true;
  problem(key, "missing");
  return false;
}

bool YamlReader::finiteNumber(const Node& node, const std::string& key, double lower, double upper,
                              double& value) {
  double number = 0.0;
  if (!node.yaml.IsScalar() || !YAML::convert<double>::decode(node.yaml, number)) {
    problem(key, node.yaml.IsScalar() ? "\"" + node.yaml.Scalar() + "\" is not a number"
                                      : "must be one number");
    return false;
  }
  if (!std::isfinite(number)) {
    problem(key, "must be finite");
    return false;
  }
  if (!(number >= lower && number <= upper)) {
    problem(key, format("%g is outside [%g, %g]", number, lower, upper));
    return false;
  }
  value = number;
  return true;
}

void YamlReader::number(const std::string& key, double& value, double lower, double upper) {
  know(key);
  if (has(key)) finiteNumber(Node{node_->yaml[key]}, key, lower, upper, value);
}

void YamlReader::requiredNumber(const std::string& key, double& value, double lower, double upper) {
  if (require(key)) finiteNumber(Node{node_->yaml[key]}, key, lower, upper, value);
}

void YamlReader::text(const std::string& key, std::string& value) {
  know(key);
  if (!has(key)) return;
  if (node_->yaml[key].IsScalar())
    value = node_->yaml[key].Scalar();
  else
    problem(key, "must be text");
}

void YamlReader::requiredText(const std::string& key, std::string& value) {
  if (require(key)) text(key, value);
}

void YamlReader::flag(const std::string& key, bool& value) {
  know(key);
  if (has(key) && !YAML::convert<bool>::decode(node_->yaml[key], value))
    problem(key, "must be true or false");
}

void YamlReader::choice(const std::string& key, int& value,
                        const std::vector<std::string>& allowed) {
  std::string word;
  text(key, word);
  if (word.empty()) return;
  const auto found = std::find(allowed.begin(), allowed.end(), word);
  if (found == allowed.end())
    problem(key, "\"" + word + "\" is not one of: " + joined(allowed));
  else
    value = static_cast<int>(found - allowed.begin());
}

void YamlReader::numberList(const std::string& key, std::vector<double>& value, double lower,
                            double upper) {
  know(key);
  if (!has(key)) return;
  const YAML::Node sequence = node_->yaml[key];
  if (!sequence.IsSequence()) {
    problem(key, "must be a list of numbers");
    return;
  }
  std::vector<double> read(sequence.size());
  bool good = true;
  for (std::size_t i = 0; i < read.size(); ++i) {
    const std::string place = key + format("[%zu]", i);
    good = finiteNumber(Node{sequence[i]}, place, lower, upper, read[i]) && good;
  }
  if (good) value = read;
}

void YamlReader::numbers(const std::string& key, Eigen::Ref<Eigen::VectorXd> value, double lower,
                         double upper) {
  std::vector<double> read(value.data(), value.data() + value.size());
  numberList(key, read, lower, upper);
  if (static_cast<Eigen::Index>(read.size()) != value.size())
    problem(key, format("must be a list of %d numbers", static_cast<int>(value.size())));
  else
    value = Eigen::Map<const Eigen::VectorXd>(read.data(), value.size());
}

void YamlReader::requiredMatrix(const std::string& key, Eigen::Matrix4d& value) {
  if (!require(key)) return;
  const YAML::Node rows = node_->yaml[key];
  bool shaped = rows.IsSequence() && rows.size() == 4;
  for (std::size_t i = 0; shaped && i < 4; ++i)
    shaped = rows[i].IsSequence() && rows[i].size() == 4;
  if (!shaped) {
    problem(key, "must be four rows of four numbers");
    return;
  }
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      finiteNumber(Node{rows[i][j]}, key + format("[%d][%d]", i, j), -1e3, 1e3, value(i, j));
}

bool YamlReader::isSection(const std::string& key) const {
  return has(key) && node_->yaml[key].IsMap();
}

YamlReader YamlReader::section(const std::string& key) {
  know(key);
  const std::string place = place_.empty() ? key : place_ + "." + key;
  if (isSection(key))
    return YamlReader(file_, std::make_shared<Node>(Node{node_->yaml[key]}), place);
  if (has(key)) problem(key, "must be a mapping (`key: value` lines)");
  return YamlReader(file_, std::make_shared<Node>(Node{YAML::Node(YAML::NodeType::Map)}), place);
}

std::vector<YamlReader> YamlReader::list(const std::string& key) {
  know(key);
  std::vector<YamlReader> readers;
  if (!has(key)) return readers;
  const YAML::Node sequence = node_->yaml[key];
  if (!sequence.IsSequence()) {
    problem(key, "must be a list (lines that start with `-`)");
    return readers;
  }
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    const std::string element = key + format("[%d]", static_cast<int>(i));
    if (!sequence[i].IsMap()) {
      problem(element, "must be a mapping (`key: value` lines)");
      continue;
    }
    readers.push_back(YamlReader(file_, std::make_shared<Node>(Node{sequence[i]}),
                                 place_.empty() ? element : place_ + "." + element));
  }
  return readers;
}

void YamlReader::refuseUnknownKeys() {
  for (const std::string& key : keys()) {
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    std::string nearest;
    std::size_t distance = 3;  // more than two changes are another word
    for (const std::string& candidate : known_) {
      const std::size_t d = editDistance(key, candidate);
      if (d < distance) {
        distance = d;
        nearest = candidate;
      }
    }
    problem(key, nearest.empty() ? "unknown key; known here: " + joined(known_)
                                 : "unknown key; did you mean " + nearest + "?");
  }
}

void YamlReader::throwIfAnyProblem() const {
  if (file_->problems.empty()) return;
  std::string text =
      format("%s: %d problem%s", file_->path.c_str(), static_cast<int>(file_->problems.size()),
             file_->problems.size() == 1 ? "" : "s");
  for (const std::string& problem : file_->problems) text += "\n  " + problem;
  throw InvalidInput(text);
}

}  // namespace raven_correction
