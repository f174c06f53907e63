// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/table_one_report.h"

#include <cmath>

#include "raven_correction/error.h"
#include "report_json.h"

namespace raven_correction {
namespace {

constexpr Method kMethods[6] = {
    Method::kNone,    Method::kRigid,           Method::kRigidClean,
    Method::kRigidGp, Method::kRigidGpVelocity, Method::kRigidGpVelocityClean};

/// Of the process: position in the base frame, rotation vector.
const char* const kOutputs[6] = {"dx", "dy", "dz", "rx", "ry", "rz"};

struct MeanStd {
  double mean, std;
};

/// Table I of Mahler et al. 2014 (mm, deg): variables in rows, methods in columns.
constexpr MeanStd kPaperDirty[6][6] = {
    {{17.6, 8.3}, {4.2, 10.2}, {2.6, 4.6}, {4.2, 9.9}, {1.6, 3.9}, {1.6, 1.6}},
    {{17.5, 5.0}, {6.0, 4.7}, {5.9, 3.9}, {2.6, 3.8}, {1.6, 1.9}, {1.5, 1.5}},
    {{9.0, 7.4}, {8.3, 7.2}, {8.1, 6.4}, {2.3, 5.1}, {1.5, 2.2}, {1.4, 1.6}},
    {{5.5, 10.4}, {4.9, 9.8}, {4.6, 7.8}, {2.0, 7.1}, {1.8, 3.4}, {1.4, 2.3}},
    {{11.6, 9.3}, {7.7, 9.4}, {6.9, 7.0}, {3.2, 7.9}, {1.9, 3.6}, {1.5, 1.8}},
    {{22.3, 22.5}, {7.3, 23.6}, {12.0, 21.9}, {1.7, 9.4}, {2.1, 3.4}, {1.7, 3.3}}};
constexpr MeanStd kPaperClean[6][6] = {
    {{17.4, 2.6}, {2.9, 2.3}, {2.6, 2.1}, {3.4, 3.2}, {1.3, 1.3}, {1.4, 1.7}},
    {{17.1, 4.1}, {5.8, 3.5}, {4.0, 4.2}, {2.2, 2.1}, {1.5, 1.6}, {1.4, 1.5}},
    {{7.5, 4.2}, {7.8, 6.2}, {7.1, 5.3}, {1.6, 1.5}, {1.3, 1.3}, {1.1, 1.2}},
    {{3.2, 2.7}, {2.8, 1.8}, {2.9, 6.2}, {1.3, 1.8}, {1.5, 2.1}, {1.3, 2.0}},
    {{10.8, 6.4}, {6.0, 2.3}, {5.9, 4.2}, {2.3, 2.3}, {1.7, 2.0}, {1.6, 1.9}},
    {{16.6, 9.8}, {6.3, 3.2}, {6.6, 9.8}, {1.7, 3.2}, {2.0, 3.4}, {1.9, 3.1}}};

double paperNorm(const MeanStd (&table)[6][6], int method, int first) {
  double sum = 0.0;
  for (int v = first; v < first + 3; ++v) sum += table[v][method].mean * table[v][method].mean;
  return std::sqrt(sum);
}

const char* const kHeader =
    "                     none         rigid       rigid +      rigid +          + vel.    + vel. "
    "+\n"
    "                                             cleaning           GP                   "
    "cleaning\n";

/// One line over the methods that predict deviations, a dash for the others.
template <typename Value>
std::string intervalLine(const std::string& name, const ErrorSummary* const (&columns)[6],
                         Value&& value) {
  std::string text = format("  %-10s", name.c_str());
  for (const ErrorSummary* column : columns)
    text += std::isfinite(value(*column)) ? format("  %6.2f      ", value(*column))
                                          : std::string("       -      ");
  return text + "\n";
}

void appendTable(const TableOneResult& result, const std::string& configuration, bool clean,
                 std::string& text) {
  const ErrorSummary* columns[6];
  for (int m = 0; m < 6; ++m)
    columns[m] = &result.row(configuration, kMethods[m], clean, kMeanOfFolds).errors;
  for (int v = 0; v < 6; ++v) {
    text += format("  %-5s %-4s", kVariables[v], unitName(v));
    for (const ErrorSummary* column : columns)
      text +=
          format("  %5.2f+-%-5.2f", unitOf(v) * column->mean_abs(v), unitOf(v) * column->std(v));
    text += '\n';
  }
  const auto line = [&](const char* name, auto&& value) {
    text += format("  %-10s", name);
    for (const ErrorSummary* column : columns) text += format("  %6.2f      ", value(*column));
    text += '\n';
  };
  line("norm mm", [](const ErrorSummary& s) { return kMillimetre * s.position_norm; });
  line("norm deg", [](const ErrorSummary& s) { return kDegree * s.angle_norm; });
  line("in tool mm", [](const ErrorSummary& s) { return kMillimetre * s.position_norm_paper; });
  line("angle deg", [](const ErrorSummary& s) { return kDegree * s.angle_mean; });
  line("median mm", [](const ErrorSummary& s) { return kMillimetre * s.position_median; });
  line("p95 mm", [](const ErrorSummary& s) { return kMillimetre * s.position_p95; });
  for (int v = 0; v < 6; ++v)
    text += intervalLine(format("in 95%% %s", kOutputs[v]), columns,
                         [v](const ErrorSummary& s) { return 100.0 * s.coverage95(v); });
  for (int v = 0; v < 6; ++v)
    text += intervalLine(format("nlpd %s", kOutputs[v]), columns,
                         [v](const ErrorSummary& s) { return s.nlpd(v); });
}

void appendPaper(const MeanStd (&table)[6][6], std::string& text) {
  for (int v = 0; v < 6; ++v) {
    text += format("  %-5s %-4s", kVariables[v], unitName(v));
    for (int m = 0; m < 6; ++m)
      text += format("  %5.1f+-%-5.1f", table[v][m].mean, table[v][m].std);
    text += '\n';
  }
  text += "  norm mm   ";
  for (int m = 0; m < 6; ++m) text += format("  %6.2f      ", paperNorm(table, m, 0));
  text += "\n  norm deg  ";
  for (int m = 0; m < 6; ++m) text += format("  %6.2f      ", paperNorm(table, m, 3));
  text += '\n';
}

void appendFolds(const TableOneResult& result, const std::string& configuration, bool clean,
                 std::string& text) {
  for (int fold = 0;; ++fold) {
    bool found = false;
    for (const TableOneRow& row : result.rows)
      found |= row.configuration == configuration && row.clean == clean && row.fold == fold;
    if (!found) break;
    text += format("  fold %d    ", fold);
    for (const Method method : kMethods) {
      const ErrorSummary& errors = result.row(configuration, method, clean, fold).errors;
      text +=
          format("  %5.2f/%-6.2f", kMillimetre * errors.position_norm, kDegree * errors.angle_norm);
    }
    const TableOneRow& full = result.row(configuration, Method::kRigidGpVelocityClean, clean, fold);
    text += format("  n test %zu, train %zu\n", full.errors.n, full.n_train);
  }
}

Json outputsJson(const Eigen::Matrix<double, 6, 1>& values) {
  Json json;
  for (int v = 0; v < 6; ++v) json[kOutputs[v]] = values(v);
  return json;
}

std::string foldName(int fold) { return fold == kMeanOfFolds ? "mean" : std::to_string(fold); }

}  // namespace

std::string tableOneText(const TableOneResult& result) {
  std::vector<std::string> configurations;
  for (const TableOneRow& row : result.rows)
    if (configurations.empty() || configurations.back() != row.configuration)
      configurations.push_back(row.configuration);
  std::string text =
      "Table I: mean +- standard deviation of |error| between predicted and real command, on\n"
      "trajectories not used in training. norm: of the three means. in tool: norm of the mean\n"
      "|translation of inv(predicted) true|, the paper's measure. angle: mean rotation angle.\n"
      "in 95%: percent of the true (dx dy dz, rx ry rz) inside the predicted 95 % interval.\n"
      "nlpd: mean negative log predictive density of the same [nat; m, rad].\n";
  for (const bool clean : {false, true}) {
    const char* const set = clean ? "clean" : "dirty";
    for (const std::string& configuration : configurations) {
      const TableOneRow& full =
          result.row(configuration, Method::kRigidGpVelocityClean, clean, kMeanOfFolds);
      text += format("\n%s test set, configuration \"%s\" (n test %zu, train %zu)\n", set,
                     configuration.c_str(), full.errors.n, full.n_train);
      text += kHeader;
      appendTable(result, configuration, clean, text);
      appendFolds(result, configuration, clean, text);
    }
    text += format("\n%s test set, as printed in the paper (Mahler et al. 2014, Table I)\n", set);
    text += kHeader;
    appendPaper(clean ? kPaperClean : kPaperDirty, text);
  }
  text += format("\ndelay of the observation behind the command: %.4f s\n", result.delay);
  text += format("observations: %zu in all, %s\n", result.fates.total(),
                 describe(result.fates).c_str());
  text += format("commands: %zu identity poses removed\n", result.identity_commands);
  return text;
}

std::string tableOneJson(const TableOneResult& result) {
  Json rows = Json::array();
  for (const TableOneRow& row : result.rows) {
    Json json;
    json["configuration"] = row.configuration;
    json["method"] = methodName(row.method);
    json["test_set"] = row.clean ? "clean" : "dirty";
    json["fold"] = foldName(row.fold);
    json["mean_abs"] = componentsJson(row.errors.mean_abs);
    json["std"] = componentsJson(row.errors.std);
    json["position_norm_mm"] = kMillimetre * row.errors.position_norm;
    json["angle_norm_deg"] = kDegree * row.errors.angle_norm;
    json["position_median_mm"] = kMillimetre * row.errors.position_median;
    json["position_p95_mm"] = kMillimetre * row.errors.position_p95;
    json["position_norm_paper_mm"] = kMillimetre * row.errors.position_norm_paper;
    json["angle_mean_deg"] = kDegree * row.errors.angle_mean;
    if (row.errors.coverage95.allFinite()) {
      json["coverage95"] = outputsJson(row.errors.coverage95);
      json["nlpd"] = outputsJson(row.errors.nlpd);
    }
    json["n_test"] = row.errors.n;
    json["n_train"] = row.n_train;
    rows.push_back(json);
  }
  Json json;
  json["rows"] = rows;
  json["delay_s"] = result.delay;
  json["cleaning"] = cleaningJson(result.fates, result.identity_commands);
  return json.dump(1) + "\n";
}

}  // namespace raven_correction
