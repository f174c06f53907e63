// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/test_trace_report.h"

#include "raven_correction/error.h"
#include "report_json.h"

namespace raven_correction {
namespace {

constexpr double kWidth = 900.0, kHeight = 230.0;  // of a panel [px]
constexpr double kTwoSided95 = 1.96;               // normal deviations
constexpr const char* kAxes[3] = {"x", "y", "z"};

/// What is drawn and written of every state.
struct Curve {
  const char* key;
  const char* label;
  Ink ink;
  Stroke stroke;
  Pose TraceState::*pose;
};
const Curve kCurves[4] = {
    {"observed", "seen by the cameras (no correction)", Ink::kVermilion, Stroke::kDotted,
     &TraceState::observed},
    {"rigid", "rigid step", Ink::kGreen, Stroke::kDashed, &TraceState::rigid},
    {"command", "command that was sent (truth)", Ink::kBlack, Stroke::kSolid, &TraceState::command},
    {"full", "whole model", Ink::kSky, Stroke::kSolid, &TraceState::full}};

struct MethodErrors {
  const char* key;
  const char* label;
  const ErrorSummary* errors;
};
std::vector<MethodErrors> methodsOf(const TraceResult& result) {
  return {{"none", "no correction", &result.none},
          {"rigid", "rigid step", &result.rigid},
          {"full", "whole model", &result.full}};
}

/// Calls `add(number, state)` state after state, and `gap(number)` where another motion begins.
template <typename Add, typename Gap>
void along(const TraceResult& result, const Add& add, const Gap& gap) {
  for (std::size_t i = 0; i < result.states.size(); ++i) {
    const auto number = static_cast<double>(i + 1);
    if (i > 0 && result.states[i].trajectory != result.states[i - 1].trajectory) gap(number - 0.5);
    add(number, result.states[i]);
  }
}

Axis numberAxis() { return {"test state, in order of time", ""}; }

Figure traceFigure(const TraceResult& result) {
  Figure figure;
  figure.title = "Command, observation and what the model says, along the motions held out";
  figure.columns = 1;
  for (int axis = 0; axis < 3; ++axis) {
    Panel panel;
    panel.title = kAxes[axis];
    panel.width = kWidth;
    panel.height = kHeight;
    panel.x = numberAxis();
    panel.y = Axis(std::string("position ") + kAxes[axis], "mm");
    for (const Curve& curve : kCurves) {
      Line line;
      line.label = curve.label;
      line.ink = curve.ink;
      line.stroke = curve.stroke;
      along(
          result,
          [&](double number, const TraceState& state) {
            line.x.push_back(number);
            line.y.push_back(kMillimetre * (state.*curve.pose).p(axis));
          },
          [&](double number) {
            line.x.push_back(number);
            line.y.push_back(kUnset);
          });
      panel.layers.push_back(line);
    }
    figure.panels.push_back(panel);
  }
  figure.how_to_read =
      "Each motion of the robot is a piece of the curves. The model is given where the tool was "
      "seen, and says which command led there; it has learnt from other motions. Base frame.";
  figure.good = "the curve of the whole model lies on that of the command.";
  return figure;
}

Figure remainderFigure(const TraceResult& result) {
  Figure figure;
  figure.title = "What the whole model leaves";
  figure.columns = 1;
  for (int axis = 0; axis < 3; ++axis) {
    Panel panel;
    panel.title = std::string(kAxes[axis]) + ", command minus what the model says";
    panel.width = kWidth;
    panel.height = kHeight;
    panel.x = numberAxis();
    panel.y = Axis("error", "mm");
    Band band;
    band.label = "95 % interval that the model predicts";
    band.ink = Ink::kSky;
    Line line;
    line.label = "error of the whole model";
    line.ink = Ink::kBlue;
    along(
        result,
        [&](double number, const TraceState& state) {
          const double half = kMillimetre * kTwoSided95 * state.sd_position(axis);
          band.x.push_back(number);
          band.lower.push_back(-half);
          band.upper.push_back(half);
          line.x.push_back(number);
          line.y.push_back(kMillimetre * (state.command.p(axis) - state.full.p(axis)));
        },
        [&](double number) {
          line.x.push_back(number);
          line.y.push_back(kUnset);
        });
    panel.layers.push_back(band);
    panel.layers.push_back(line);
    figure.panels.push_back(panel);
  }
  figure.how_to_read =
      "The difference of two curves of the figure above, enlarged, and how large the model says "
      "that it is.";
  figure.good = "the line stays close to zero, and leaves the band about once in twenty states.";
  return figure;
}

HtmlTable errorTable(const TraceResult& result) {
  HtmlTable table;
  table.caption = "Mean absolute errors of the commands, on the states of the figure.";
  table.header = {"", "x [mm]", "y [mm]", "z [mm]", "norm [mm]", "norm of yaw, pitch, roll [deg]"};
  table.numeric = {false, true, true, true, true, true};
  for (const MethodErrors& method : methodsOf(result)) {
    std::vector<std::string> row{method.label};
    for (int axis = 0; axis < 3; ++axis)
      row.push_back(format("%.2f", kMillimetre * method.errors->mean_abs(axis)));
    row.push_back(format("%.2f", kMillimetre * method.errors->position_norm));
    row.push_back(format("%.2f", kDegree * method.errors->angle_norm));
    table.rows.push_back(row);
  }
  return table;
}

}  // namespace

std::string testTraceText(const TraceResult& result) {
  std::string text = format(
      "first %zu of %zu clean test states of %zu motions held out; learnt from %zu pairs; delay "
      "%.1f ms\n\n%-16s %8s %8s %8s %10s %10s\n",
      result.states.size(), result.clean_states, result.test_trajectories, result.n_train,
      kMillimetre * result.delay, "mean abs. error", "x [mm]", "y [mm]", "z [mm]", "norm [mm]",
      "norm [deg]");
  for (const MethodErrors& method : methodsOf(result)) {
    const ErrorSummary& errors = *method.errors;
    text += format("%-16s %8.2f %8.2f %8.2f %10.2f %10.2f\n", method.label,
                   kMillimetre * errors.mean_abs(0), kMillimetre * errors.mean_abs(1),
                   kMillimetre * errors.mean_abs(2), kMillimetre * errors.position_norm,
                   kDegree * errors.angle_norm);
  }
  return text;
}

std::string testTraceJson(const TraceResult& result) {
  Json json;
  json["states"] = result.states.size();
  json["clean_states"] = result.clean_states;
  json["test_trajectories"] = result.test_trajectories;
  json["n_train"] = result.n_train;
  json["delay_s"] = result.delay;
  for (const MethodErrors& method : methodsOf(result)) {
    const Eigen::Vector3d mean = kMillimetre * method.errors->mean_abs.head<3>();
    json["errors"][method.key] = {{"mean_abs_mm", {mean.x(), mean.y(), mean.z()}},
                                  {"position_norm_mm", kMillimetre * method.errors->position_norm},
                                  {"angle_norm_deg", kDegree * method.errors->angle_norm}};
  }
  Json& trace = json["trace"];
  for (const TraceState& state : result.states) {
    trace["trajectory"].push_back(state.trajectory);
    for (int axis = 0; axis < 3; ++axis) {
      Json& of_axis = trace[std::string(kAxes[axis]) + "_mm"];
      for (const Curve& curve : kCurves)
        of_axis[curve.key].push_back(kMillimetre * (state.*curve.pose).p(axis));
      of_axis["sd"].push_back(kMillimetre * state.sd_position(axis));
    }
  }
  return json.dump(1) + "\n";
}

std::string testTraceHtml(const TraceResult& result, const RunRecord& run) {
  HtmlDocument document("The correction along motions",
                        "Position of the tool over test states of motions that the model has not "
                        "learnt from (Fig. 4 of Mahler et al. 2014).");
  const double none = kMillimetre * result.none.position_norm;
  const double rigid = kMillimetre * result.rigid.position_norm;
  const double full = kMillimetre * result.full.position_norm;
  const bool better = full < rigid && full < none;
  document.verdict(
      better ? Tone::kGood : Tone::kWarning,
      format("The model leaves %.2f of %.2f mm; the rigid step alone leaves %.2f mm.", full, none,
             rigid),
      {format("The first %zu of %zu clean test states of %zu motions held out, after learning from "
              "%zu pairs of the other motions.",
              result.states.size(), result.clean_states, result.test_trajectories, result.n_train),
       format("The observation is %.0f ms behind the command.", kMillimetre * result.delay)},
      {better ? "Compare all folds and methods: evaluate INPUT --report R.html."
              : "Look for what differs between the motions: evaluate INPUT --report R.html says "
                "which data were rejected, and where the robot has been."});
  document.section("Errors");
  document.table(errorTable(result));
  document.section("Traces");
  document.figure(traceFigure(result));
  document.figure(remainderFigure(result));
  appendProvenance(run, document);
  return document.text();
}

}  // namespace raven_correction
