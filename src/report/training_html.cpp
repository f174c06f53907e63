// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/training_html.h"

#include <algorithm>
#include <cmath>

#include "error_figures.h"
#include "health_html.h"
#include "paper_table_one.h"
#include "raven_correction/error.h"
#include "raven_correction/report/figure_limits.h"
#include "report_json.h"

namespace raven_correction {
namespace {

constexpr std::size_t kDots = 1500;     // of kept samples in one panel
constexpr double kManyRejected = 0.2;   // of the observations [-]
constexpr double kPoorlyCovered = 0.7;  // of the cells [-]
constexpr double kNarrow = 0.90;        // of what 95 % intervals should cover [-]

struct Judged {
  ErrorSeries none, rigid, full;
  ErrorSummary none_summary, rigid_summary, full_summary;
};
Judged judge(const HeldOutErrors& errors) {
  Judged judged;
  append(errors.none, judged.none);
  append(errors.rigid, judged.rigid);
  append(errors.full, judged.full);
  judged.none_summary = summarise(errors.none);
  judged.rigid_summary = summarise(errors.rigid);
  judged.full_summary = summarise(errors.full);
  return judged;
}

std::string place(const CoverageCell& cell) {
  return format(
      "x %.0f, y %.0f, z %.0f mm (%zu commands went there, %zu could be learnt from, of "
      "%zu motions)",
      kMillimetre * cell.centre.x(), kMillimetre * cell.centre.y(), kMillimetre * cell.centre.z(),
      cell.commands, cell.kept, cell.trajectories);
}

/// What physics says about the pairs, and how many it does not reach.
std::string physicsText(const TrainingResult& result) {
  return format(
      "Physics: the way back through the simulation %s leaves %.2f mm and %.2f deg RMS on the "
      "pairs "
      "learnt from, the rigid step %.2f mm and %.2f deg. %zu more pairs are out of its reach, and "
      "were not learnt from.",
      result.simulation.c_str(), kMillimetre * result.physics_rms_position,
      kDegree * result.physics_rms_angle, kMillimetre * result.rigid_rms_position,
      kDegree * result.rigid_rms_angle, result.out_of_reach);
}

void appendVerdict(const TrainingResult& result, const TrainingPage& page, const Judged& judged,
                   HtmlDocument& document) {
  const ErrorSummary& none = judged.none_summary;
  const ErrorSummary& full = judged.full_summary;
  const double kept = static_cast<double>(result.fates[Fate::kKept]);
  const double all = static_cast<double>(std::max<std::size_t>(1, result.fates.total()));
  const double covered = static_cast<double>(page.coverage.covered) /
                         static_cast<double>(std::max<std::size_t>(1, page.coverage.cells.size()));
  const bool helps = full.position_norm < none.position_norm && full.angle_norm < none.angle_norm;
  std::vector<std::string> found, next;
  found.push_back(format(
      "Learnt from %zu pairs of %zu trajectories; %.1f %% of the observations "
      "were kept.",
      result.model.training_pairs, result.model.training_trajectories, kPercent * kept / all));
  found.push_back(page.judged);
  if (!result.simulation.empty()) {
    found.push_back(physicsCaveat(result, page));
    found.push_back(physicsText(result));
  }
  found.push_back(format("%zu of %zu places that the robot was sent to are covered.",
                         page.coverage.covered, page.coverage.cells.size()));
  if (helps)
    next.push_back(
        "Load the model into the corrector (~model, or the trainer's ~load) and switch it "
        "on: " +
        page.model_file);
  else
    next.emplace_back(
        "Do not switch this model on: it does not help on trajectories left out of its fit.");
  if (covered < kPoorlyCovered && !page.coverage.record_more.empty())
    next.push_back("Record more around " + place(page.coverage.record_more.front()) +
                   "; more places are listed below.");
  if (kept < (1.0 - kManyRejected) * all)
    next.emplace_back(
        "Much was rejected: see the reasons below, and mend their cause before the "
        "next recording.");
  if (result.delay.status != DelayResult::Status::kOk &&
      result.delay.status != DelayResult::Status::kNotRun)
    next.push_back(std::string("Delay: ") + delayStatusText(result.delay.status) + ".");
  if (full.coverage95.allFinite() && full.coverage95.minCoeff() < kNarrow)
    next.emplace_back(
        "The predicted intervals promise too much on trajectories not seen: record "
        "more motions, rather than longer ones.");
  // What the process has not seen, its simulation may have.
  const char* const on = isJudgedFairly(result, page) ? "On trajectories it has not seen"
                                                      : "On trajectories left out of its fit";
  document.verdict(helps ? Tone::kGood : Tone::kWarning,
                   format("%s, the correction turns %.1f mm and %.1f deg into %.2f mm and "
                          "%.2f deg.",
                          on, kMillimetre * none.position_norm, kDegree * none.angle_norm,
                          kMillimetre * full.position_norm, kDegree * full.angle_norm),
                   found, next);
  document.keyNumbers(
      {{"position, norm",
        format("%.2f \xE2\x86\x92 %.2f mm", kMillimetre * none.position_norm,
               kMillimetre * full.position_norm),
        format("%zu held-out states", full.n)},
       {"orientation, norm",
        format("%.2f \xE2\x86\x92 %.2f deg", kDegree * none.angle_norm, kDegree * full.angle_norm),
        ""},
       {"delay", format("%.1f ms", 1e3 * result.model.delay), "observation behind command"},
       {"rigid step leaves",
        format("%.2f mm, %.2f deg", kMillimetre * result.rigid_rms_position,
               kDegree * result.rigid_rms_angle),
        "RMS on the pairs learnt from"}});
}

void appendHeldOut(const TrainingResult& result, const TrainingPage& page, const Judged& judged,
                   HtmlDocument& document) {
  document.section("Errors on trajectories left out");
  document.paragraph(page.judged);
  if (!result.simulation.empty()) document.paragraph(physicsCaveat(result, page));
  HtmlTable table;
  table.caption =
      "Mean \xC2\xB1 standard deviation of the absolute error of the predicted command.";
  table.header = {"", "no correction", "rigid step alone", "all steps"};
  table.numeric = {false, true, true, true};
  const ErrorSummary* const columns[] = {&judged.none_summary, &judged.rigid_summary,
                                         &judged.full_summary};
  for (int v = 0; v < 6; ++v) {
    std::vector<std::string> row{format("%s [%s]", kVariables[v], unitName(v))};
    for (const ErrorSummary* column : columns)
      row.push_back(format("%.2f \xC2\xB1 %.2f", unitOf(v) * column->mean_abs(v),
                           unitOf(v) * column->std(v)));
    table.rows.push_back(row);
  }
  std::vector<std::string> position{"norm [mm]"}, angle{"norm [deg]"};
  for (const ErrorSummary* column : columns) {
    position.push_back(format("%.2f", kMillimetre * column->position_norm));
    angle.push_back(format("%.2f", kDegree * column->angle_norm));
  }
  table.emphasised = {table.rows.size(), table.rows.size() + 1};
  table.rows.insert(table.rows.end(), {position, angle});
  document.table(table);
  document.figure(
      errorCurvesFigure({{"no correction", Ink::kVermilion, Stroke::kDashed, &judged.none},
                         {"rigid step alone", Ink::kGrey, Stroke::kDotted, &judged.rigid},
                         {"all steps", Ink::kBlue, Stroke::kSolid, &judged.full}}));
  document.figure(errorAxesFigure(judged.none, judged.full));
  if (!judged.full.standardised.empty())
    document.figure(coverageFigure(coverageOf(judged.full.standardised)));
}

Points positions(const std::vector<Pose>& poses, int a, int b, std::size_t most) {
  Points points;
  const std::size_t stride = std::max<std::size_t>(1, poses.size() / most);
  for (std::size_t i = 0; i < poses.size(); i += stride) {
    points.x.push_back(kMillimetre * poses[i].p(a));
    points.y.push_back(kMillimetre * poses[i].p(b));
  }
  return points;
}

Figure workspaceFigure(const WorkspaceCoverage& coverage) {
  Figure figure;
  figure.title = "Where the model has learnt";
  const std::pair<int, int> views[] = {{0, 1}, {0, 2}};
  const char* const names[] = {"x", "y", "z"};
  for (const auto& [a, b] : views) {
    Panel panel;
    panel.title = std::string("seen along ") + names[3 - a - b];
    panel.height = 340.0;
    panel.x = Axis(std::string("commanded ") + names[a], "mm");
    panel.y = Axis(std::string("commanded ") + names[b], "mm");
    Points kept = positions(coverage.kept, a, b, kDots);
    kept.label = "learnt from";
    kept.ink = Ink::kSky;
    Points rejected = positions(coverage.rejected, a, b, kDots);
    rejected.label = "rejected";
    rejected.ink = Ink::kVermilion;
    rejected.marker = Marker::kSquare;
    rejected.size = 3.0;
    Points more;
    more.label = "record more here";
    more.ink = Ink::kBlack;
    more.marker = Marker::kDiamond;
    more.size = 12.0;
    for (const CoverageCell& cell : coverage.record_more) {
      more.x.push_back(kMillimetre * cell.centre(a));
      more.y.push_back(kMillimetre * cell.centre(b));
    }
    panel.layers = {kept, rejected, more};
    figure.panels.push_back(panel);
  }
  figure.how_to_read =
      "Commanded positions (base frame) whose observation was learnt from, and those whose "
      "observation was rejected. Outside the cloud the correction fades out.";
  figure.good =
      "an even cloud that is wider than the task, without holes and without knots of "
      "rejected samples.";
  return figure;
}

Figure rangesFigure(const WorkspaceCoverage& coverage) {
  Figure figure;
  figure.title = "Speeds and orientations that the model has seen";
  struct Part {
    const char* title;
    const char* label;
    const char* unit;
    const std::vector<double>& values;
    double scale;
  };
  for (const Part& part :
       {Part{"Speed", "speed of the tool", "mm/s", coverage.speed, kMillimetre},
        Part{"Orientation", "angle from the mean orientation", "deg", coverage.angle, kDegree}}) {
    std::vector<double> values = part.values;
    for (double& value : values) value *= part.scale;
    Panel panel;
    panel.title = part.title;
    panel.height = 230.0;
    panel.x = Axis(part.label, part.unit);
    panel.y = Axis("samples learnt from", "");
    Axis room;
    limitTo(room, values, 0.995);
    if (std::isfinite(room.upper)) {
      Histogram histogram = histogramOf(values, 0.0, room.upper, 30);
      histogram.ink = Ink::kSky;
      panel.layers.push_back(histogram);
    }
    figure.panels.push_back(panel);
  }
  figure.how_to_read = "Samples per bin; the last bin holds what lies beyond, too.";
  figure.good = "both reach as far as the task does: what was never seen cannot be corrected.";
  return figure;
}

void appendCoverage(const WorkspaceCoverage& coverage, HtmlDocument& document) {
  document.section("Where it has learnt, and where to record more");
  document.paragraph(
      format("The robot was sent to %zu cubes of %.0f mm; %zu of them hold at least ten samples of "
             "two motions.",
             coverage.cells.size(), kMillimetre * coverage.cell, coverage.covered));
  if (!coverage.record_more.empty()) {
    document.paragraph("Record more around (position in the base frame):");
    std::vector<std::string> places;
    for (const CoverageCell& cell : coverage.record_more) places.push_back(place(cell));
    document.list(places);
  }
  document.figure(workspaceFigure(coverage));
  document.figure(rangesFigure(coverage));
}

Figure delayFigure(const DelayResult& delay) {
  Figure figure;
  figure.title = "Delay of the observation behind the command";
  figure.columns = 1;
  Panel panel;
  panel.height = 230.0;
  panel.x = Axis("delay tried", "ms");
  panel.y = Axis("median residual", "mm");
  Line line;
  line.ink = Ink::kBlue;
  line.markers = true;
  for (std::size_t i = 0; i < delay.tried.size(); ++i) {
    line.x.push_back(1e3 * delay.tried[i]);
    line.y.push_back(kMillimetre * delay.residual[i]);
  }
  Rule chosen;
  chosen.label = "chosen";
  chosen.vertical = true;
  chosen.value = 1e3 * delay.delay;
  panel.layers = {line, chosen};
  figure.panels.push_back(panel);
  figure.how_to_read =
      "What a rigid transform leaves if the command of that much earlier is taken.";
  figure.good = "one clear valley away from both ends.";
  return figure;
}

void appendModel(const TrainingResult& result, HtmlDocument& document) {
  document.section("The model");
  document.paragraph(
      format("Rigid step: leaves %.2f mm and %.2f deg RMS on the pairs learnt from. "
             "Least median of squares: robust deviation %.2f mm.",
             kMillimetre * result.rigid_rms_position, kDegree * result.rigid_rms_angle,
             kMillimetre * result.least_median_scale));
  if (!result.simulation.empty()) document.paragraph(physicsText(result));
  HtmlTable table;
  table.caption = format(
      "What the process has learnt of each output: how large the correction beyond %s is (signal), "
      "and what no feature explains (noise), as standard deviations.",
      result.simulation.empty() ? "the rigid step" : "what physics says");
  table.header = {"output", "unit", "signal", "noise", "length scales (smallest, median, largest)",
                  "search"};
  table.numeric = {false, false, true, true, true, false};
  for (std::size_t g = 0; g < result.model.process.groups.size(); ++g) {
    const GpGroup& group = result.model.process.groups[g];
    std::vector<double> scales(group.length_scales.data(),
                               group.length_scales.data() + group.length_scales.size());
    std::sort(scales.begin(), scales.end());
    for (std::size_t k = 0; k < group.outputs.size(); ++k) {
      const int output = group.outputs[k];
      const auto i = static_cast<Eigen::Index>(k);
      table.rows.push_back(
          {kOutputs[output], unitName(output),
           format("%.2f", unitOf(output) * std::sqrt(group.signal_variance(i))),
           format("%.2f", unitOf(output) * std::sqrt(group.noise_variance(i))),
           scales.empty() ? "-"
                          : format("%.3g, %.3g, %.3g", scales.front(), scales[scales.size() / 2],
                                   scales.back()),
           g < result.process.groups.size() ? result.process.groups[g].message : ""});
    }
  }
  if (!table.rows.empty()) {
    document.table(table);
    document.paragraph(
        format("%d pairs in the posterior; %.1f s for hyper-parameters, %.1f s for "
               "the posterior.",
               result.process.rows_used, result.process.seconds_hyperparameters,
               result.process.seconds_posterior));
  }
  document.paragraph(
      format("Delay %.1f ms, %s.", 1e3 * result.model.delay, delayStatusText(result.delay.status)));
  if (!result.delay.tried.empty()) document.figure(delayFigure(result.delay));
}

}  // namespace

std::string trainingHtml(const TrainingResult& result, const TrainingPage& page,
                         const RunRecord& run) {
  HtmlDocument document("Training of " + result.model.id,
                        "What was learnt from which data, and how good it is on trajectories left "
                        "out of its fit.");
  const Judged judged = judge(page.held_out);
  appendVerdict(result, page, judged, document);
  appendHeldOut(result, page, judged, document);
  appendCoverage(page.coverage, document);
  appendModel(result, document);
  document.section("Data health");
  appendFindings(page.findings, document);
  appendFates(result.fates, result.identity_commands, document);
  appendStreams(page.streams, document);
  RunRecord record = run;
  record.settings.emplace_back("model", page.model_file + ", " + result.model.id);
  record.settings.emplace_back("hash of the pairs learnt from", result.model.input_hash);
  record.configuration = result.model.configuration;
  appendProvenance(record, document);
  return document.text();
}

}  // namespace raven_correction
