// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/number_table.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "raven_correction/error.h"
#include "report_json.h"

namespace raven_correction {
namespace {

constexpr char kRows[] = "rows";

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + '"';
}

using Fields = std::vector<std::pair<std::string, std::string>>;  // name and value

void flatten(const Json& json, const std::string& name, Fields& fields) {
  if (json.is_object() || json.is_array()) {
    std::size_t index = 0;
    for (const auto& item : json.items()) {
      const std::string key = json.is_object() ? item.key() : std::to_string(index++);
      flatten(item.value(), name.empty() ? key : name + "." + key, fields);
    }
    return;
  }
  fields.emplace_back(name, json.is_null()     ? ""
                            : json.is_string() ? json.get<std::string>()
                                               : json.dump());
}

std::string line(const std::vector<std::string>& cells) {
  std::string text;
  for (std::size_t i = 0; i < cells.size(); ++i) text += (i == 0 ? "" : ",") + quoted(cells[i]);
  return text + "\n";
}

}  // namespace

std::string csvOfJson(const std::string& json) {
  const Json whole = Json::parse(json, nullptr, false);
  if (!whole.is_object()) throw InvalidInput("these numbers are not a JSON object");
  const auto found = whole.find(kRows);
  const bool table =
      found != whole.end() && found->is_array() && !found->empty() &&
      std::all_of(found->begin(), found->end(), [](const Json& row) { return row.is_object(); });
  if (!table) {
    Fields fields;
    flatten(whole, "", fields);
    std::string text = line({"quantity", "value"});
    for (const auto& [name, value] : fields) text += line({name, value});
    return text;
  }
  Json others = whole;
  others.erase(kRows);
  Fields same;
  flatten(others, "", same);
  std::vector<std::string> names;
  std::vector<std::map<std::string, std::string>> lines;
  for (const Json& row : *found) {
    Fields fields;
    flatten(row, "", fields);
    lines.emplace_back();
    for (const auto& [name, value] : fields) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
      lines.back()[name] = value;
    }
  }
  std::vector<std::string> cells = names;
  for (const auto& [name, value] : same) cells.push_back(name);
  std::string text = line(cells);
  for (const auto& row : lines) {
    cells.clear();
    for (const std::string& name : names) {
      const auto value = row.find(name);
      cells.push_back(value == row.end() ? "" : value->second);
    }
    for (const auto& [name, value] : same) cells.push_back(value);
    text += line(cells);
  }
  return text;
}

}  // namespace raven_correction
