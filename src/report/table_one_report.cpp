// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/table_one_report.h"

#include <cmath>

#include "paper_table_one.h"
#include "raven_correction/error.h"
#include "report_json.h"

namespace raven_correction {
namespace {

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

void appendPaper(const PaperTable& table, std::string& text) {
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
  const std::vector<std::string> configurations = configurationsOf(result);
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
    appendPaper(paperTable(clean), text);
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
