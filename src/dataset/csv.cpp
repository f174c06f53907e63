// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/dataset/csv.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

std::string_view trim(std::string_view text) {
  const char* const blank = " \t\r";
  const std::size_t first = text.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(trim(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

}  // namespace

CsvTable readCsv(const std::string& file, const std::string& label_column, CsvNumbers numbers) {
  std::ifstream stream(file);
  if (!stream)
    throw InvalidInput(
        format("%s: cannot be read; is the name right, may you read it?", file.c_str()));
  CsvTable table;
  table.file = file;
  std::string line;
  if (!std::getline(stream, line) || trim(line).empty())
    throw InvalidInput(
        format("%s:1: no header line; the first line names the columns", file.c_str()));
  const std::vector<std::string_view> header = split(line);
  const std::size_t first = label_column.empty() ? 0 : 1;
  if (first == 1 && header.front() != label_column)
    throw InvalidInput(format("%s:1: first column is \"%.*s\", expected \"%s\"", file.c_str(),
                              static_cast<int>(header.front().size()), header.front().data(),
                              label_column.c_str()));
  table.columns.assign(header.begin() + static_cast<std::ptrdiff_t>(first), header.end());

  std::vector<double> values;
  std::size_t number = 1;
  while (std::getline(stream, line)) {
    ++number;
    if (trim(line).empty()) continue;
    const std::vector<std::string_view> fields = split(line);
    if (fields.size() != header.size())
      throw InvalidInput(format("%s:%zu: %zu fields, the header has %zu; is the line cut off?",
                                file.c_str(), number, fields.size(), header.size()));
    table.lines.push_back(number);
    if (first == 1) table.labels.emplace_back(fields.front());
    for (std::size_t k = first; k < fields.size(); ++k) {
      double value = 0.0;
      const std::string_view field = fields[k];
      const auto parsed = std::from_chars(field.data(), field.data() + field.size(), value);
      if (parsed.ec != std::errc() || parsed.ptr != field.data() + field.size())
        throw InvalidInput(format("%s:%zu: column %s: \"%.*s\" is not a number", file.c_str(),
                                  number, table.columns[k - first].c_str(),
                                  static_cast<int>(field.size()), field.data()));
      if (numbers == CsvNumbers::kFinite && !std::isfinite(value))
        throw InvalidInput(format("%s:%zu: column %s is %.*s; remove the line or mend its source",
                                  file.c_str(), number, table.columns[k - first].c_str(),
                                  static_cast<int>(field.size()), field.data()));
      values.push_back(value);
    }
  }
  if (values.empty()) throw InvalidInput(format("%s: no row after the header", file.c_str()));
  const auto columns = static_cast<Eigen::Index>(table.columns.size());
  const auto rows = static_cast<Eigen::Index>(values.size()) / columns;
  table.values = Eigen::Map<decltype(table.values)>(values.data(), rows, columns);
  return table;
}

}  // namespace raven_correction
