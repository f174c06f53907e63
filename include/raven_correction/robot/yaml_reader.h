// SPDX-License-Identifier: BSD-3-Clause
// Reads a YAML file strictly and patiently: every missing key, unknown key, wrong type and value
// out of range is collected, with its place, and reported in one message. Hides the YAML library.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace raven_correction {

/// A mapping of a YAML file. Readers of the same file share one list of problems. A key that is
/// asked for is known; read optional values with the default already in the variable.
class YamlReader {
 public:
  /// @throws InvalidInput  the file cannot be read, is not YAML, or is not a mapping
  static YamlReader fromFile(const std::string& path);
  /// @param name  stands for the file in messages
  static YamlReader fromText(const std::string& text, const std::string& name);

  bool has(const std::string& key) const;
  /// Keys of this mapping, in the order of the file.
  std::vector<std::string> keys() const;

  /// Finite number in [lower, upper].
  void number(const std::string& key, double& value,
              double lower = -std::numeric_limits<double>::max(),
              double upper = std::numeric_limits<double>::max());
  void requiredNumber(const std::string& key, double& value,
                      double lower = -std::numeric_limits<double>::max(),
                      double upper = std::numeric_limits<double>::max());
  void text(const std::string& key, std::string& value);
  void requiredText(const std::string& key, std::string& value);
  void flag(const std::string& key, bool& value);
  /// One of `allowed`; its place there.
  void choice(const std::string& key, int& value, const std::vector<std::string>& allowed);
  /// A list of exactly value.size() finite numbers in [lower, upper].
  void numbers(const std::string& key, Eigen::Ref<Eigen::VectorXd> value,
               double lower = -std::numeric_limits<double>::max(),
               double upper = std::numeric_limits<double>::max());
  /// A list of any number of finite numbers in [lower, upper].
  void numberList(const std::string& key, std::vector<double>& value,
                  double lower = -std::numeric_limits<double>::max(),
                  double upper = std::numeric_limits<double>::max());
  /// Four rows of four numbers; the last is 0 0 0 1.
  void requiredMatrix(const std::string& key, Eigen::Matrix4d& value);
  /// The mapping under this key; an empty one, and a problem, if it is something else.
  YamlReader section(const std::string& key);
  /// The list of mappings under this key.
  std::vector<YamlReader> list(const std::string& key);
  /// The key holds a mapping.
  bool isSection(const std::string& key) const;

  /// Adds a problem of one's own. @param key  where; may be empty for the whole mapping
  void problem(const std::string& key, const std::string& text);
  /// A problem for every key that nobody has asked for, with the nearest known one.
  void refuseUnknownKeys();
  /// @throws InvalidInput  naming the file and all problems, if there are any
  void throwIfAnyProblem() const;

 private:
  struct File;
  struct Node;
  YamlReader(std::shared_ptr<File> file, std::shared_ptr<const Node> node, std::string place);
  void know(const std::string& key);
  bool require(const std::string& key);
  bool finiteNumber(const Node& node, const std::string& key, double lower, double upper,
                    double& value);

  std::shared_ptr<File> file_;
  std::shared_ptr<const Node> node_;
  std::string place_;  // of this mapping in the file, for messages
  std::vector<std::string> known_;
};

}  // namespace raven_correction
