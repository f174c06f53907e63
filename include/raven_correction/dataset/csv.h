// SPDX-License-Identifier: BSD-3-Clause
// Tables of numbers in CSV files: one header line, comma separated, an optional first column of
// text. Errors name the file, the line and the column. What the tables mean is
// dataset_directory.h.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace raven_correction {

struct CsvTable {
  std::string file;                  ///< for messages
  std::vector<std::string> columns;  ///< names of the numeric columns
  std::vector<std::string> labels;   ///< text of the first column, one per row; empty without one
  std::vector<std::size_t> lines;    ///< line of each row in the file, counted from 1
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>
      values;  ///< rows x columns
};

enum class CsvNumbers { kFinite, kAny };  ///< kAny lets nan and inf pass

/// @param label_column  name that the first column must have if it is text; empty: all are numbers
/// @param numbers       whether nan and inf are an error
/// @throws InvalidInput  the file cannot be read, has no header or no row, a row is too short or
///         too long, a field is not a number, or not finite where that is asked for
CsvTable readCsv(const std::string& file, const std::string& label_column,
                 CsvNumbers numbers = CsvNumbers::kFinite);

}  // namespace raven_correction
