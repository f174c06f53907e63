// SPDX-License-Identifier: BSD-3-Clause
// Where tests find the measured data sets that are not part of the package, and a reader for
// plain tables of numbers.
#pragma once

#include <Eigen/Core>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace raven_correction {

/// Folder or file below the data: $RAVEN_CORRECTION_DATA, else ../shared/data beside the source
/// tree (tests run in the source tree). Empty when it does not exist.
inline std::string testData(const std::string& name) {
  const char* const root = std::getenv("RAVEN_CORRECTION_DATA");
  const std::string path = std::string(root != nullptr ? root : "../shared/data") + "/" + name;
  return std::ifstream(path).good() ? path : std::string();
}

/// Numbers of a comma-separated file, one matrix row per line, after `header_lines` lines.
inline Eigen::MatrixXd readTable(const std::string& path, int header_lines = 0) {
  std::ifstream file(path);
  std::vector<double> values;
  std::string line;
  Eigen::Index rows = 0;
  for (int i = 0; i < header_lines; ++i) std::getline(file, line);
  while (std::getline(file, line)) {
    if (line.empty()) continue;
    std::istringstream cells(line);
    std::string cell;
    while (std::getline(cells, cell, ',')) values.push_back(std::stod(cell));
    ++rows;
  }
  if (rows == 0) throw std::runtime_error("no rows in " + path);
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const RowMajor>(values.data(), rows, Eigen::Index(values.size()) / rows);
}

}  // namespace raven_correction

/// Skips the test, saying what is missing, when `path` is empty.
#define RAVEN_SKIP_WITHOUT_DATA(path, name) \
  if ((path).empty())                       \
  GTEST_SKIP() << "data set " << (name)     \
               << " not found; set RAVEN_CORRECTION_DATA to the folder that holds it"
