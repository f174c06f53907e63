// SPDX-License-Identifier: BSD-3-Clause
#include "debridement_words.h"
#include "raven_correction/error.h"
#include "raven_correction/report/debridement_report.h"
#include "report_json.h"

namespace raven_correction {
namespace {

/// One bar per condition, with its interval.
Panel conditionPanel(const DebridementReport& report, const std::string& title, const Axis& axis,
                     double (*value)(const DebridementSummary&),
                     Interval (*interval)(const DebridementSummary&)) {
  Panel panel;
  panel.title = title;
  panel.height = 90.0 + 40.0 * static_cast<double>(report.conditions.size());
  panel.x = axis;
  panel.x.from_zero = true;
  Bars bars;
  bars.horizontal = true;
  bars.decimals = 1;
  for (const DebridementCondition& condition : report.conditions) {
    const DebridementSummary summary = summarise(condition.fields, report.seed);
    panel.y.categories.push_back(condition.name);
    bars.position.push_back(static_cast<double>(bars.position.size()));
    bars.value.push_back(value(summary));
    bars.lower.push_back(interval(summary).lower);
    bars.upper.push_back(interval(summary).upper);
  }
  panel.layers.push_back(bars);
  return panel;
}

Figure conditionsFigure(const DebridementReport& report) {
  using S = DebridementSummary;
  Figure figure;
  figure.title = "Time and success of every condition";
  figure.panels.push_back(conditionPanel(
      report, "Time per fragment", Axis("simulated time per delivered fragment", "s"),
      [](const S& s) { return s.seconds_per_fragment; },
      [](const S& s) { return s.seconds_interval; }));
  figure.panels.push_back(conditionPanel(
      report, "Success", Axis("delivered fragments", "%"),
      [](const S& s) { return kPercent * s.success; },
      [](const S& s) {
        return Interval{kPercent * s.success_interval.lower, kPercent * s.success_interval.upper};
      }));
  figure.how_to_read =
      "Bars: over all scenes. Whiskers: 95 % of resampled scenes, which were the same in every "
      "condition.";
  figure.good =
      "the corrected bars of time are short, and those of success as long as the baseline's.";
  return figure;
}

/// How long each fragment took an arm, as cumulative shares.
Figure timesFigure(const DebridementReport& report) {
  Figure figure;
  figure.title = "Time of an arm for one fragment";
  figure.columns = 1;
  Panel panel;
  panel.x = Axis("from its choice to its end", "s");
  panel.x.from_zero = true;
  panel.y = Axis("share of the fragments", "%");
  const Ink inks[] = {Ink::kVermilion, Ink::kBlue, Ink::kGreen};
  const Stroke strokes[] = {Stroke::kDashed, Stroke::kSolid, Stroke::kDotted};
  for (std::size_t i = 0; i < report.conditions.size(); ++i) {
    std::vector<double> times;
    for (const ClearedField& field : report.conditions[i].fields)
      for (const FragmentRecord& record : field.records) times.push_back(record.end - record.begin);
    Line line = cumulativeOf(times);
    line.label = report.conditions[i].name;
    line.ink = inks[i % 3];
    line.stroke = strokes[i % 3];
    panel.layers.push_back(line);
  }
  figure.panels.push_back(panel);
  figure.how_to_read =
      "A step to the right after the steep part are fragments that needed more than one attempt.";
  figure.good = "the corrected lines rise steeply far left of the baseline's.";
  return figure;
}

std::string words(const PairedComparison& speed_up) {
  return format("%.2f (%.2f to %.2f)", speed_up.value, speed_up.interval.lower,
                speed_up.interval.upper);
}

void appendVerdict(const DebridementReport& report, HtmlDocument& document) {
  const DebridementCondition* const slow = conditionOf(report, kBaseline);
  const DebridementCondition* const fast = conditionOf(report, kCorrected);
  if (slow == nullptr || fast == nullptr) {
    document.verdict(Tone::kNotice, "Not all conditions were run.", {},
                     {"Leave --condition out to compare them."});
    return;
  }
  const DebridementSummary before = summarise(slow->fields, report.seed);
  const DebridementSummary after = summarise(fast->fields, report.seed);
  const std::optional<PairedComparison> speed_up = speedUpOf(report, kCorrected);
  if (!speed_up) {
    document.verdict(Tone::kWarning, "The baseline delivered nothing.", {},
                     {"Look at grasps.csv (--output) for why its jaws closed on nothing."});
    return;
  }
  const PairedComparison success = *successOf(report, kCorrected);
  const bool kept = success.value >= 0.0;
  const bool faster = speed_up->interval.lower > 1.0;
  std::vector<std::string> found{
      format("%.1f s per fragment instead of %.1f s; the paper: %.1f s and %.1f times faster.",
             after.seconds_per_fragment, before.seconds_per_fragment, kPaperSecondsPerFragment,
             kPaperSpeedUp),
      format(
          "%.1f %% of the fragments were delivered, %.1f %% by the baseline: %+.1f points (%+.1f "
          "to %+.1f), %s.",
          kPercent * after.success, kPercent * before.success, kPercent * success.value,
          kPercent * success.interval.lower, kPercent * success.interval.upper,
          successWords(success)),
      "The intervals are of these scenes and these models: arms that learn again differ, too."};
  std::vector<std::string> next;
  if (kept)
    next.emplace_back("Repeat it with another --seed before relying on the difference.");
  else
    next.emplace_back(
        "Learn from more places (--rehearsals), or let the planner replan where the correction is "
        "not sure (condition corrected_replanning).");
  document.verdict(
      kept && faster ? Tone::kGood : Tone::kWarning,
      format("With the correction debridement is %s times faster; its success rate is %s.",
             words(*speed_up).c_str(),
             kept ? "no lower than the baseline's" : "LOWER than the baseline's"),
      found, next);
}

}  // namespace

std::string debridementHtml(const DebridementReport& report, const RunRecord& run) {
  HtmlDocument document(
      "Debridement",
      "Fragments of foam found, picked up and carried away: slowly and replanning, "
      "and fast with the learnt correction.");
  appendVerdict(report, document);
  document.section("Conditions");
  HtmlTable table;
  table.caption = "Simulated time; the same scenes in every condition.";
  table.header = {"quantity"};
  std::vector<DebridementSummary> summaries;
  for (const DebridementCondition& condition : report.conditions) {
    table.header.push_back(condition.name);
    summaries.push_back(summarise(condition.fields, report.seed));
  }
  for (const DebridementRow& row : debridementRows()) {
    std::vector<std::string> cells{row.name};
    for (std::size_t i = 0; i < summaries.size(); ++i)
      cells.push_back(row.value(report.conditions[i], summaries[i]));
    table.rows.push_back(cells);
  }
  document.table(table);
  document.figure(conditionsFigure(report));
  document.figure(timesFigure(report));
  document.section("What was learnt");
  HtmlTable learnt;
  learnt.caption =
      "Before and after: on trajectories of the last rehearsal that the trainer kept out of the "
      "fit "
      "(before: without this model, but at the places to which the one before it brought the "
      "tool). "
      "Trial: at rest at places like those of the task, by motion capture.";
  learnt.header = {"arm",          "places",      "pairs",      "before [mm]",  "after [mm]",
                   "before [deg]", "after [deg]", "trial [mm]", "usual sd [mm]"};
  learnt.numeric = {false, true, true, true, true, true, true, true, true};
  for (const DebridementLearning& arm : report.learning)
    learnt.rows.push_back({arm.arm, std::to_string(arm.places), std::to_string(arm.pairs),
                           format("%.1f", arm.before_mm), format("%.2f", arm.after_mm),
                           format("%.1f", arm.before_deg), format("%.2f", arm.after_deg),
                           format("%.2f", kMillimetre * arm.trial_deviation),
                           format("%.2f", kMillimetre * arm.usual_prediction)});
  document.table(learnt);
  appendProvenance(run, document);
  return document.text();
}

}  // namespace raven_correction
