// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/table_one_html.h"

#include "health_html.h"
#include "paper_table_one.h"
#include "raven_correction/error.h"
#include "raven_correction/report/axis_scale.h"
#include "report_json.h"
#include "table_one_figures.h"

namespace raven_correction {
namespace {

constexpr double kNarrow = 0.90;  // of what 95 % intervals should cover: below, they mislead [-]
constexpr double kWide = 0.985;   // above, they say less than the data do [-]
constexpr double kClearly = 0.9;  // times the error of everything: a simpler method is better [-]
constexpr double kUneven = 1.5;   // worst over best fold: the folds are not alike [-]

/// The whole table of one configuration, or of the paper.
HtmlTable methodsTable(const std::string& caption) {
  HtmlTable table;
  table.caption = caption;
  table.header = {""};
  for (const Method method : kMethods) table.header.emplace_back(methodWords(method));
  table.numeric.assign(table.header.size(), true);
  table.numeric[0] = false;
  return table;
}

void appendTable(const TableOneResult& result, const std::string& configuration, bool clean,
                 HtmlDocument& document) {
  const TableOneRow& full = result.row(configuration, kFull, clean, kMeanOfFolds);
  HtmlTable table = methodsTable(
      format("%s test set, %s: mean \xC2\xB1 standard deviation of the absolute error; %zu test "
             "states, %zu pairs learnt from.",
             clean ? "Clean" : "Dirty", configurationLabel(configuration).c_str(), full.errors.n,
             full.n_train));
  const auto add = [&](const std::string& name, auto&& value) {
    std::vector<std::string> row{name};
    for (const Method method : kMethods)
      row.push_back(value(meanOfFolds(result, configuration, method, clean)));
    table.rows.push_back(row);
  };
  for (int v = 0; v < 6; ++v)
    add(format("%s [%s]", kVariables[v], unitName(v)), [v](const ErrorSummary& s) {
      return format("%.2f \xC2\xB1 %.2f", unitOf(v) * s.mean_abs(v), unitOf(v) * s.std(v));
    });
  const auto number = [](double value) { return numberText(value, 2); };
  add("norm [mm]", [&](const ErrorSummary& s) { return number(kMillimetre * s.position_norm); });
  add("norm [deg]", [&](const ErrorSummary& s) { return number(kDegree * s.angle_norm); });
  table.emphasised = {table.rows.size() - 2, table.rows.size() - 1};
  add("median [mm]",
      [&](const ErrorSummary& s) { return number(kMillimetre * s.position_median); });
  add("p95 [mm]", [&](const ErrorSummary& s) { return number(kMillimetre * s.position_p95); });
  add("mean angle [deg]", [&](const ErrorSummary& s) { return number(kDegree * s.angle_mean); });
  document.table(table);
}

void appendPaper(bool clean, HtmlDocument& document) {
  HtmlTable table = methodsTable(
      format("%s test set, as printed in the paper (Table I).", clean ? "Clean" : "Dirty"));
  const PaperTable& paper = paperTable(clean);
  for (int v = 0; v < 6; ++v) {
    std::vector<std::string> row{format("%s [%s]", kVariables[v], unitName(v))};
    for (int m = 0; m < 6; ++m)
      row.push_back(format("%.1f \xC2\xB1 %.1f", paper[v][m].mean, paper[v][m].std));
    table.rows.push_back(row);
  }
  for (const int first : {0, 3}) {
    std::vector<std::string> row{first == 0 ? "norm [mm]" : "norm [deg]"};
    for (int m = 0; m < 6; ++m) row.push_back(numberText(paperNorm(paper, m, first), 2));
    table.rows.push_back(row);
  }
  table.emphasised = {table.rows.size() - 2, table.rows.size() - 1};
  document.table(table);
}

void appendFolds(const TableOneResult& result, HtmlDocument& document) {
  HtmlTable table;
  table.caption = "Norms of every fold, clean test set, all steps.";
  table.header = {"configuration",     "fold",        "position [mm]",
                  "orientation [deg]", "test states", "pairs learnt from"};
  table.numeric = {false, true, true, true, true, true};
  for (const std::string& configuration : configurationsOf(result))
    for (const TableOneRow* row : foldsOf(result, configuration, kFull, true))
      table.rows.push_back({configuration, std::to_string(row->fold),
                            numberText(normOf(row->errors, true), 2),
                            numberText(normOf(row->errors, false), 2),
                            std::to_string(row->errors.n), std::to_string(row->n_train)});
  if (!table.rows.empty()) document.table(table);
}

void appendCalibration(const TableOneResult& result, const ErrorSamples& samples,
                       HtmlDocument& document) {
  document.section("How far the predicted deviations can be trusted");
  const std::string own = configurationsOf(result).back();
  const ErrorSummary& errors = meanOfFolds(result, own, kFull, true);
  if (!errors.coverage95.allFinite()) {
    document.paragraph("The configuration predicts no deviations.");
    return;
  }
  HtmlTable table;
  table.caption =
      "Share of the true commands inside the predicted 95 % interval, and mean negative log "
      "predictive density [nat; m, rad] (lower is better); clean test set.";
  table.header = {""};
  std::vector<std::string> coverage{"inside 95 % [%]"}, nlpd{"density"};
  for (int v = 0; v < 6; ++v) {
    table.header.emplace_back(kOutputs[v]);
    coverage.push_back(numberText(kPercent * errors.coverage95(v), 1));
    nlpd.push_back(numberText(errors.nlpd(v), 2));
  }
  table.rows = {coverage, nlpd};
  table.numeric.assign(table.header.size(), true);
  table.numeric[0] = false;
  document.table(table);
  document.figure(calibrationFigure(result, samples));
}

/// What the numbers say, and what to do about it.
void appendVerdict(const TableOneResult& result, HtmlDocument& document) {
  const std::string own = configurationsOf(result).back();
  const ErrorSummary& none = meanOfFolds(result, own, Method::kNone, true);
  const ErrorSummary& rigid = meanOfFolds(result, own, Method::kRigidClean, true);
  const ErrorSummary& full = meanOfFolds(result, own, kFull, true);
  const double position = full.position_norm / none.position_norm;
  const double angle = full.angle_norm / none.angle_norm;
  const bool helps = position < 1.0 && angle < 1.0;
  const bool learns = full.position_norm < rigid.position_norm;
  std::vector<std::string> found, next;
  found.push_back(format("The rigid step alone leaves %.2f mm and %.2f deg.",
                         kMillimetre * rigid.position_norm, kDegree * rigid.angle_norm));
  if (full.coverage95.allFinite())
    found.push_back(
        format("The predicted 95 %% intervals cover %.1f to %.1f %% of the true "
               "commands.",
               kPercent * full.coverage95.minCoeff(), kPercent * full.coverage95.maxCoeff()));
  found.push_back(format("Observations lag behind commands by %.0f ms.", 1e3 * result.delay));
  Range folds;
  for (const TableOneRow* row : foldsOf(result, own, kFull, true))
    folds.include(row->errors.position_norm);
  if (!helps)
    next.emplace_back(
        "Do not switch the correction on: it does not help on trajectories it has not "
        "seen. Look at the data health below, then record more trajectories.");
  else if (!learns)
    next.emplace_back(
        "What was learnt on top of the rigid step does not help: record more "
        "trajectories, or use the mode \"rigid\".");
  else
    next.emplace_back("Train on all trajectories (train) and switch the correction on.");
  Method best = kFull;
  for (const Method method : kMethods)
    if (meanOfFolds(result, own, method, true).position_norm <
        kClearly * meanOfFolds(result, own, best, true).position_norm)
      best = method;
  if (best != kFull)
    next.push_back(format(
        "\"%s\" alone is better here (%.2f mm): there is too little data for what "
        "comes after it. Record more, or switch that off in the configuration.",
        methodWords(best), kMillimetre * meanOfFolds(result, own, best, true).position_norm));
  if (full.coverage95.allFinite() && full.coverage95.minCoeff() < kNarrow)
    next.emplace_back(
        "Intervals promise too much: do not let the planner rely on the deviations; "
        "more trajectories, not more samples, mend it.");
  if (full.coverage95.allFinite() && full.coverage95.maxCoeff() > kWide)
    next.emplace_back(
        "Intervals are wider than needed: the correction may fade out where it is "
        "good.");
  if (!folds.empty() && folds.upper > kUneven * folds.lower)
    next.emplace_back(
        "The folds differ much: single trajectories decide. Record more of them, "
        "spread over the workspace.");
  const double rejected = result.fates.total() == 0
                              ? 0.0
                              : 1.0 - static_cast<double>(result.fates[Fate::kKept]) /
                                          static_cast<double>(result.fates.total());
  if (rejected > 0.2)
    next.push_back(format("Cleaning rejects %.0f %% of the observations: see which reasons below.",
                          kPercent * rejected));
  document.verdict(
      helps ? Tone::kGood : Tone::kWarning,
      format("On trajectories it has not seen, the correction turns %.1f mm and %.1f deg into %.2f "
             "mm and %.2f deg (%.0f and %.0f %% of it).",
             kMillimetre * none.position_norm, kDegree * none.angle_norm,
             kMillimetre * full.position_norm, kDegree * full.angle_norm, kPercent * position,
             kPercent * angle),
      found, next);
  document.keyNumbers(
      {{"position, norm",
        format("%.2f \xE2\x86\x92 %.2f mm", kMillimetre * none.position_norm,
               kMillimetre * full.position_norm),
        format("median %.2f, p95 %.2f mm", kMillimetre * full.position_median,
               kMillimetre * full.position_p95)},
       {"orientation, norm",
        format("%.2f \xE2\x86\x92 %.2f deg", kDegree * none.angle_norm, kDegree * full.angle_norm),
        format("mean angle %.2f deg", kDegree * full.angle_mean)},
       {"delay", format("%.0f ms", 1e3 * result.delay), "of the observation behind the command"},
       {"observations kept", format("%.1f %%", kPercent * (1.0 - rejected)),
        format("%zu of %zu", result.fates[Fate::kKept], result.fates.total())}});
}

}  // namespace

std::string tableOneHtml(const TableOneResult& result, const ErrorSamples& samples,
                         const std::vector<StreamHealth>& streams, const RunRecord& run) {
  HtmlDocument document(
      "Evaluation",
      "How well the correction predicts commands on trajectories not used in training: Table I of "
      "Mahler et al. 2014.");
  appendVerdict(result, document);
  document.section("Table I");
  document.figure(ladderFigure(result));
  for (const bool clean : {true, false}) {
    const std::vector<std::string> configurations = configurationsOf(result);
    for (auto name = configurations.rbegin(); name != configurations.rend(); ++name)
      appendTable(result, *name, clean, document);
    appendPaper(clean, document);
  }
  document.section("Errors before and after");
  document.figure(distributionFigure(result, samples));
  document.figure(axesFigure(result, samples));
  if (!foldsOf(result, configurationsOf(result).back(), kFull, true).empty()) {
    document.section("Folds");
    document.figure(foldsFigure(result));
    appendFolds(result, document);
  }
  appendCalibration(result, samples, document);
  document.section("Data health");
  document.paragraph(format("Delay of the observation behind the command, from all data: %.1f ms.",
                            1e3 * result.delay));
  appendFates(result.fates, result.identity_commands, document);
  appendStreams(streams, document);
  appendProvenance(run, document);
  return document.text();
}

}  // namespace raven_correction
