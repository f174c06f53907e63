// SPDX-License-Identifier: BSD-3-Clause
#include "paper_table_one.h"

#include <cmath>

namespace raven_correction {
namespace {

constexpr PaperTable kPaperDirty = {
    {{17.6, 8.3}, {4.2, 10.2}, {2.6, 4.6}, {4.2, 9.9}, {1.6, 3.9}, {1.6, 1.6}},
    {{17.5, 5.0}, {6.0, 4.7}, {5.9, 3.9}, {2.6, 3.8}, {1.6, 1.9}, {1.5, 1.5}},
    {{9.0, 7.4}, {8.3, 7.2}, {8.1, 6.4}, {2.3, 5.1}, {1.5, 2.2}, {1.4, 1.6}},
    {{5.5, 10.4}, {4.9, 9.8}, {4.6, 7.8}, {2.0, 7.1}, {1.8, 3.4}, {1.4, 2.3}},
    {{11.6, 9.3}, {7.7, 9.4}, {6.9, 7.0}, {3.2, 7.9}, {1.9, 3.6}, {1.5, 1.8}},
    {{22.3, 22.5}, {7.3, 23.6}, {12.0, 21.9}, {1.7, 9.4}, {2.1, 3.4}, {1.7, 3.3}}};
constexpr PaperTable kPaperClean = {
    {{17.4, 2.6}, {2.9, 2.3}, {2.6, 2.1}, {3.4, 3.2}, {1.3, 1.3}, {1.4, 1.7}},
    {{17.1, 4.1}, {5.8, 3.5}, {4.0, 4.2}, {2.2, 2.1}, {1.5, 1.6}, {1.4, 1.5}},
    {{7.5, 4.2}, {7.8, 6.2}, {7.1, 5.3}, {1.6, 1.5}, {1.3, 1.3}, {1.1, 1.2}},
    {{3.2, 2.7}, {2.8, 1.8}, {2.9, 6.2}, {1.3, 1.8}, {1.5, 2.1}, {1.3, 2.0}},
    {{10.8, 6.4}, {6.0, 2.3}, {5.9, 4.2}, {2.3, 2.3}, {1.7, 2.0}, {1.6, 1.9}},
    {{16.6, 9.8}, {6.3, 3.2}, {6.6, 9.8}, {1.7, 3.2}, {2.0, 3.4}, {1.9, 3.1}}};

}  // namespace

const char* methodWords(Method method) noexcept {
  switch (method) {
    case Method::kNone:
      return "none";
    case Method::kRigid:
      return "rigid";
    case Method::kRigidClean:
      return "rigid + cleaning";
    case Method::kRigidGp:
      return "rigid + GP";
    case Method::kRigidGpVelocity:
      return "+ velocity";
    case Method::kRigidGpVelocityClean:
      return "+ velocity + cleaning";
    case Method::kCount:
      break;
  }
  return "";
}

const PaperTable& paperTable(bool clean) noexcept { return clean ? kPaperClean : kPaperDirty; }

double paperNorm(const PaperTable& table, int method, int first) {
  double sum = 0.0;
  for (int v = first; v < first + 3; ++v) sum += table[v][method].mean * table[v][method].mean;
  return std::sqrt(sum);
}

std::vector<std::string> configurationsOf(const TableOneResult& result) {
  std::vector<std::string> configurations;
  for (const TableOneRow& row : result.rows)
    if (configurations.empty() || configurations.back() != row.configuration)
      configurations.push_back(row.configuration);
  return configurations;
}

}  // namespace raven_correction
