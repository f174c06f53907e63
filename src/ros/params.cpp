// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/params.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <regex>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

/// Edit distance (Levenshtein), for "did you mean".
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substitute = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({substitute, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

ParamReader::ParamReader(const ros::NodeHandle& nh, std::string node)
    : nh_(nh), node_(std::move(node)) {}

void ParamReader::problem(const std::string& name, const std::string& text) {
  problems_.push_back(format("  ~%-22s %s", name.c_str(), text.c_str()));
}

void ParamReader::remember(const std::string& name, const std::string& value) {
  values_.push_back(name + " = " + value);
}

template <typename T>
bool ParamReader::get(const std::string& name, T& value, const char* type) {
  known_.insert(name);
  if (!nh_.hasParam(name)) return false;
  if (nh_.getParam(name, value)) return true;
  problem(name, format("is not %s", type));
  return false;
}

void ParamReader::number(const std::string& name, double& value, double min, double max) {
  double given = value;
  get(name, given, "a number");
  if (!(given >= min && given <= max))
    problem(name, format("%g is outside [%g, %g]", given, min, max));
  else
    value = given;
  remember(name, format("%g", value));
}

void ParamReader::positive(const std::string& name, double& value, double max) {
  double given = value;
  get(name, given, "a number");
  if (!(given > 0.0 && given <= max))
    problem(name, format("%g is outside (0, %g]", given, max));
  else
    value = given;
  remember(name, format("%g", value));
}

void ParamReader::integer(const std::string& name, int& value, int min, int max) {
  int given = value;
  get(name, given, "a whole number");
  if (given < min || given > max)
    problem(name, format("%d is outside [%d, %d]", given, min, max));
  else
    value = given;
  remember(name, format("%d", value));
}

void ParamReader::flag(const std::string& name, bool& value) {
  get(name, value, "true or false");
  remember(name, value ? "true" : "false");
}

void ParamReader::text(const std::string& name, std::string& value) {
  get(name, value, "text");
  remember(name, "\"" + value + "\"");
}

void ParamReader::requiredText(const std::string& name, std::string& value,
                               const std::string& remedy) {
  if (!get(name, value, "text") && !nh_.hasParam(name))
    problem(name, "is missing; " + remedy);
  else if (value.empty())
    problem(name, "is empty; " + remedy);
  remember(name, "\"" + value + "\"");
}

void ParamReader::oneOf(const std::string& name, std::string& value,
                        const std::vector<std::string>& choices) {
  std::string given = value;
  get(name, given, "text");
  if (std::find(choices.begin(), choices.end(), given) != choices.end()) {
    value = given;
  } else {
    std::string list;
    for (const std::string& choice : choices) list += (list.empty() ? "" : ", ") + choice;
    problem(name, format("\"%s\" is not one of %s", given.c_str(), list.c_str()));
  }
  remember(name, value);
}

void ParamReader::numbers(const std::string& name, std::vector<double>& value, std::size_t count,
                          double min, double max) {
  std::vector<double> given = value;
  get(name, given, "a list of numbers");
  if (given.size() != count)
    problem(name, format("has %zu numbers, expected %zu", given.size(), count));
  else if (!std::all_of(given.begin(), given.end(), [&](double v) { return v >= min && v <= max; }))
    problem(name, format("has a number outside [%g, %g]", min, max));
  else
    value = given;
  std::string list;
  for (const double v : value) list += (list.empty() ? "" : ", ") + format("%g", v);
  remember(name, "[" + list + "]");
}

void ParamReader::texts(const std::string& name, std::vector<std::string>& value) {
  get(name, value, "a list of texts");
  std::string list;
  for (const std::string& text : value) list += (list.empty() ? "\"" : ", \"") + text + "\"";
  remember(name, "[" + list + "]");
}

void ParamReader::names(const std::string& name, std::vector<std::string>& value,
                        std::size_t max_count) {
  static const std::regex kName("[A-Za-z][A-Za-z0-9_]*");
  std::vector<std::string> given = value;
  get(name, given, "a list of names");
  if (given.size() > max_count)
    problem(name, format("has %zu names, at most %zu are allowed", given.size(), max_count));
  value.clear();
  for (const std::string& v : given) {
    if (!std::regex_match(v, kName))
      problem(name, format("\"%s\" is not a letter and more letters, digits or _", v.c_str()));
    else if (std::find(value.begin(), value.end(), v) != value.end())
      problem(name, format("\"%s\" is there twice", v.c_str()));
    else
      value.push_back(v);
  }
  std::string list;
  for (const std::string& v : value) list += (list.empty() ? "" : ", ") + v;
  remember(name, "[" + list + "]");
}

void ParamReader::refuseUnknownKeys(const std::vector<std::string>& known_namespaces) {
  std::vector<std::string> names;
  nh_.getParamNames(names);
  const std::string prefix = nh_.getNamespace() + "/";
  for (const std::string& full : names) {
    if (full.compare(0, prefix.size(), prefix) != 0) continue;
    const std::string key = full.substr(prefix.size());
    const std::string first = key.substr(0, key.find('/'));
    if (known_.count(key) || known_.count(first)) continue;
    if (std::find(known_namespaces.begin(), known_namespaces.end(), first) !=
        known_namespaces.end())
      continue;
    const auto nearest = std::min_element(
        known_.begin(), known_.end(),
        [&](const auto& a, const auto& b) { return distance(key, a) < distance(key, b); });
    const bool close = nearest != known_.end() && distance(key, *nearest) <= 3;
    problem(key, close ? "unknown key; did you mean " + *nearest + "?" : "unknown key; remove it");
  }
}

void ParamReader::throwIfAnyProblem() const {
  if (problems_.empty()) return;
  std::string text = format("%s: %zu problem%s in its parameters, not starting", node_.c_str(),
                            problems_.size(), problems_.size() == 1 ? "" : "s");
  for (const std::string& line : problems_) text += "\n" + line;
  throw InvalidInput(text);
}

std::string ParamReader::summary() const {
  std::string text = node_ + " parameters:";
  for (const std::string& line : values_) text += "\n  " + line;
  return text;
}

}  // namespace raven_correction
