// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "paper_table_two.h"
#include "raven_correction/error.h"
#include "raven_correction/report/repeatability_report.h"
#include "report_json.h"

namespace raven_correction {
namespace {

constexpr double kWantedShare = 0.1;    // of the uncorrected error that may be left [-]
constexpr double kWantedScatter = 1.0;  // repeatability in each axis [mm]
const char* const kAxes[] = {"x", "y", "z"};

const char* meaningOf(const std::string& condition) {
  if (condition == "none") return "without correction";
  if (condition == "full") return "every pose corrected";
  if (condition == "endpoint") return "endpoints corrected";
  return "";
}

/// One bar per axis and condition, and the paper's beside each.
Panel axisPanel(const RepeatabilityReport& report, const std::string& title, const Axis& axis,
                double (*ours)(const RepeatabilityResult&, int),
                double (*papers)(const PaperCondition&, int)) {
  Panel panel;
  panel.title = title;
  panel.y = axis;
  panel.y.from_zero = true;
  Bars here, paper;
  here.label = "here";
  here.ink = Ink::kBlue;
  paper.label = "paper";
  paper.ink = Ink::kOrange;
  paper.hollow = true;
  here.width = paper.width = 0.38;
  here.decimals = paper.decimals = 1;
  for (const RepeatabilityCondition& condition : report.conditions)
    for (int v = 0; v < 3; ++v) {
      const auto at = static_cast<double>(panel.x.categories.size());
      panel.x.categories.push_back(condition.name + " " + kAxes[v]);
      here.position.push_back(at - 0.2);
      here.value.push_back(ours(condition.result, v));
      const PaperCondition* const known = paperConditionOf(condition.name);
      paper.position.push_back(at + 0.2);
      paper.value.push_back(known == nullptr ? kUnset : papers(*known, v));
    }
  panel.layers.push_back(here);
  panel.layers.push_back(paper);
  panel.width = 900.0;
  return panel;
}

Figure errorsFigure(const RepeatabilityReport& report) {
  Figure figure;
  figure.title = "Mean absolute error of every axis";
  figure.columns = 1;
  figure.panels.push_back(axisPanel(
      report, "At rest at the poses", Axis("mean absolute error", "mm"),
      [](const RepeatabilityResult& result, int v) {
        return kMillimetre * result.errors.mean_abs(v);
      },
      [](const PaperCondition& paper, int v) { return paper.mean_abs[v]; }));
  figure.how_to_read =
      "For each condition the three axes of the base frame: here, and in Table II of the paper.";
  figure.good = "the bars of \"full\" are hardly seen beside those of \"none\".";
  return figure;
}

Figure scatterFigure(const RepeatabilityReport& report) {
  Figure figure;
  figure.title = "Scatter of the visits of one pose";
  figure.columns = 1;
  Panel panel = axisPanel(
      report, "Repeatability", Axis("standard deviation", "mm"),
      [](const RepeatabilityResult& result, int v) {
        return kMillimetre * result.repeatability(v);
      },
      [](const PaperCondition& paper, int v) { return paper.std[v]; });
  Rule wanted;
  wanted.label = "aim";
  wanted.value = kWantedScatter;
  panel.layers.push_back(wanted);
  figure.panels.push_back(panel);
  figure.how_to_read =
      "How much one visit of a pose differs from the next: every visit comes from another side, so "
      "friction and play show, and noise of motion capture.";
  figure.good = "all bars of \"full\" end below the dashed line.";
  return figure;
}

const RepeatabilityResult* resultOf(const RepeatabilityReport& report, const char* name) {
  for (const RepeatabilityCondition& condition : report.conditions)
    if (condition.name == name) return &condition.result;
  return nullptr;
}

void appendVerdict(const RepeatabilityReport& report, HtmlDocument& document) {
  const double share = correctedShare(report);
  const RepeatabilityResult* const none = resultOf(report, "none");
  const RepeatabilityResult* const full = resultOf(report, "full");
  if (none == nullptr || full == nullptr) {
    document.verdict(Tone::kNotice, "Not all conditions were run.", {}, {});
    return;
  }
  const double scatter = kMillimetre * full->repeatability.head<3>().maxCoeff();
  const bool small = share <= kWantedShare, steady = scatter < kWantedScatter;
  std::vector<std::string> found{
      format(
          "%.1f mm without correction, %.2f mm with every pose corrected (norm of the three mean "
          "absolute errors).",
          kMillimetre * none->errors.position_norm, kMillimetre * full->errors.position_norm),
      format("The visits of one pose scatter by at most %.2f mm in an axis; the aim is less than "
             "%.1f mm.",
             scatter, kWantedScatter)};
  std::vector<std::string> next;
  if (!small)
    next.emplace_back(
        "Learn from more motions (--trajectories), over the region and with the turns that the "
        "poses have.");
  if (!steady)
    next.emplace_back(
        "Let the model know the robot, so that it knows from which side each joint has come "
        "(without --no-play); what is left then is noise, or play that the model does not see.");
  if (!full->unseen.empty() || !none->unseen.empty())
    next.emplace_back("Some visits were not seen at rest: look at motion capture.");
  if (next.empty()) next.emplace_back("Repeat it with another --seed before relying on it.");
  document.verdict(small && steady ? Tone::kGood : Tone::kWarning,
                   format("The correction leaves %.1f %% of the error.", kPercent * share), found,
                   next);
}

HtmlTable conditionsTable(const RepeatabilityReport& report) {
  HtmlTable table;
  table.caption = "Mean absolute error and repeatability of each axis, measured by " +
                  report.measured_by + "; in brackets the paper.";
  table.header = {"quantity"};
  table.numeric = {false};
  for (const RepeatabilityCondition& condition : report.conditions) {
    table.header.push_back(condition.name + ": " + meaningOf(condition.name));
    table.numeric.push_back(true);
  }
  for (int v = 0; v < 6; ++v) {
    std::vector<std::string> cells{std::string(kVariables[v]) + " [" + unitName(v) + "]"};
    for (const RepeatabilityCondition& condition : report.conditions) {
      std::string cell =
          format("%.2f \xC2\xB1 %.2f", unitOf(v) * condition.result.errors.mean_abs(v),
                 unitOf(v) * condition.result.repeatability(v));
      const PaperCondition* const paper = v < 3 ? paperConditionOf(condition.name) : nullptr;
      if (paper != nullptr)
        cell += format(" (%.1f \xC2\xB1 %.1f)", paper->mean_abs[v], paper->std[v]);
      cells.push_back(cell);
    }
    table.rows.push_back(cells);
  }
  std::vector<std::string> mm{"norm [mm]"}, deg{"norm [deg]"}, seen{"visits seen at rest"};
  for (const RepeatabilityCondition& condition : report.conditions) {
    mm.push_back(format("%.2f", kMillimetre * condition.result.errors.position_norm));
    deg.push_back(format("%.2f", kDegree * condition.result.errors.angle_norm));
    seen.push_back(format("%zu of %zu", condition.result.visits,
                          condition.result.visits + condition.result.unseen.size()));
  }
  table.rows.insert(table.rows.end(), {mm, deg, seen});
  table.emphasised = {6};
  return table;
}

}  // namespace

std::string repeatabilityHtml(const RepeatabilityReport& report, const RunRecord& run) {
  HtmlDocument document(
      "Repeatability",
      format("Table II of the paper: %zu random poses, each visited %zu times open "
             "loop, in random order.",
             report.poses, report.visits));
  appendVerdict(report, document);
  document.section("Conditions");
  document.table(conditionsTable(report));
  document.figure(errorsFigure(report));
  document.figure(scatterFigure(report));
  document.section("How it was made");
  document.paragraph(
      format("Learnt from %zu pairs of %zu motions. The simulator ran at %.2f simulated seconds "
             "per second.",
             report.training_pairs, report.training_trajectories, report.clock_rate));
  appendProvenance(run, document);
  return document.text();
}

}  // namespace raven_correction
