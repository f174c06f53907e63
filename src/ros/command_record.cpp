// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/command_record.h"

#include <ctime>

namespace raven_correction {
namespace {

/// One process runs one command at a time.
std::vector<std::string>& words() {
  static std::vector<std::string> all;
  return all;
}

std::string quoted(const std::string& word) {
  const bool plain = !word.empty() && word.find_first_not_of(
                                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                          "0123456789_@%+=:,./-") == std::string::npos;
  if (plain) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

}  // namespace

void setCommandLine(int argc, const char* const* argv) {
  words().assign(argv + (argc > 0 ? 1 : 0), argv + argc);
}

std::string commandLine() {
  std::string text = "./run offline";
  for (const std::string& word : words()) text += " " + quoted(word);
  return text;
}

RunRecord recordRun(const std::vector<std::string>& inputs) {
  RunRecord run;
  run.command = commandLine();
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[40];
  std::strftime(text, sizeof(text), "%Y-%m-%d %H:%M:%S UTC", &utc);
  run.made_at = text;
  run.inputs = inputFiles(inputs);
  return run;
}

}  // namespace raven_correction
