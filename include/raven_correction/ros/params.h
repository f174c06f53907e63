// SPDX-License-Identifier: BSD-3-Clause
// Reads a node's private parameters strictly: missing, wrong type, nan, out of range and unknown
// key are different messages, collected and thrown together. No node starts on a guess.
#pragma once

#include <ros/node_handle.h>

#include <set>
#include <string>
#include <vector>

namespace raven_correction {

/// One reader per node and start. Every call names one parameter; the value given is the default
/// and stays where the parameter is not set. After the last call: throwIfAnyProblem().
class ParamReader {
 public:
  /// @param nh    private node handle of the node
  /// @param node  name for messages, e.g. "corrector"
  ParamReader(const ros::NodeHandle& nh, std::string node);

  void number(const std::string& name, double& value, double min, double max);  ///< [min, max]
  void positive(const std::string& name, double& value, double max);            ///< (0, max]
  void integer(const std::string& name, int& value, int min, int max);          ///< [min, max]
  void flag(const std::string& name, bool& value);
  void text(const std::string& name, std::string& value);
  void requiredText(const std::string& name, std::string& value, const std::string& remedy);
  void oneOf(const std::string& name, std::string& value, const std::vector<std::string>& choices);
  void numbers(const std::string& name, std::vector<double>& value, std::size_t count, double min,
               double max);
  void texts(const std::string& name, std::vector<std::string>& value);
  /// A list of at most `max_count` different names: letters, digits and _, a letter first. Only
  /// such are put into `value`.
  void names(const std::string& name, std::vector<std::string>& value, std::size_t max_count);

  /// A problem that only the caller sees.
  void problem(const std::string& name, const std::string& text);
  /// Keys set under the private namespace that no call asked for are problems, too, with the
  /// nearest known name. Keys set by ROS itself and sub-namespaces given here are left alone.
  void refuseUnknownKeys(const std::vector<std::string>& known_namespaces = {});
  /// @throws InvalidInput  lists all problems, one line each
  void throwIfAnyProblem() const;
  /// "name = value" lines of everything that was read, for one log message at start.
  std::string summary() const;

 private:
  template <typename T>
  bool get(const std::string& name, T& value, const char* type);
  void remember(const std::string& name, const std::string& value);

  ros::NodeHandle nh_;
  std::string node_;
  std::set<std::string> known_;
  std::vector<std::string> problems_;
  std::vector<std::string> values_;
};

}  // namespace raven_correction
