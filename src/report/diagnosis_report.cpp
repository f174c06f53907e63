// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/diagnosis_report.h"

#include "diagnosis_words.h"
#include "raven_correction/diagnosis/separating_recording.h"
#include "raven_correction/error.h"
#include "report_json.h"

namespace raven_correction {
namespace {

std::string errorsText(const Verdict& verdict, const char* name, const DiagnosisErrors& errors) {
  const ErrorSizes& sizes = errors.sizes;
  if (verdict.has_kinematics)
    return format("  %-34s %7.2f %7.2f %7.2f   %7.2f\n", name, kMillimetre * sizes.position_rms,
                  kMillimetre * sizes.position_median, kMillimetre * sizes.position_p95,
                  kDegree * sizes.orientation_median);
  std::string text = format("  %-34s", name);
  for (const double rms : sizes.joint_rms) text += format(" %11.3g", rms);
  return text + "\n";
}

std::string dependenceText(const char* what, const DependenceResult& result) {
  std::string text = format("  %-12s", what);
  for (const Dependence& group : orderedGroups(result))
    text += format("  %s %.0f %%", group.on.c_str(), kPercent * std::max(0.0, group.share));
  return text + format("  together %.0f %%\n", kPercent * std::max(0.0, result.anything.share));
}

std::string causesText(const Verdict& verdict) {
  if (verdict.causes.empty())
    return "Nothing is claimed: no cause in the catalogue predicts motions that it was not fitted "
           "to.\n";
  std::string text =
      verdict.causes.size() == 1
          ? std::string(
                "One cause explains it, with its share of the held-out loss that is there "
                "without it (squared, position and orientation alike):\n")
          : format(
                "%zu causes together explain it, each with its share of the held-out loss that "
                "is there without it (squared, position and orientation alike):\n",
                verdict.causes.size());
  for (std::size_t i = 0; i < verdict.causes.size(); ++i)
    text += "  " + causeText(verdict, i) + "\n";
  return text;
}

Json errorsJson(const Verdict& verdict, const DiagnosisErrors& errors) {
  const ErrorSizes& sizes = errors.sizes;
  Json json = Json::object();
  if (verdict.has_kinematics) {
    json["position_rms_mm"] = kMillimetre * sizes.position_rms;
    json["position_median_mm"] = kMillimetre * sizes.position_median;
    json["position_p95_mm"] = kMillimetre * sizes.position_p95;
    json["orientation_median_deg"] = kDegree * sizes.orientation_median;
    json["orientation_rms_deg"] = kDegree * sizes.orientation_rms;
    for (const double value : errors.fold_position_median)
      json["fold_position_median_mm"].push_back(kMillimetre * value);
    for (const double value : errors.fold_orientation_median)
      json["fold_orientation_median_deg"].push_back(kDegree * value);
    return json;
  }
  for (std::size_t j = 0; j < sizes.joint_rms.size(); ++j) {
    const std::string unit = jointUnit(verdict, j);
    json[verdict.joints[j]] = {{"rms_" + unit, sizes.joint_rms[j]},
                               {"median_" + unit, sizes.joint_median[j]},
                               {"p95_" + unit, sizes.joint_p95[j]}};
  }
  return json;
}

Json intervalJson(double lower, double upper) { return {kPercent * lower, kPercent * upper}; }

Json dependenceJson(const DependenceResult& result) {
  Json json = Json::object();
  std::vector<Dependence> groups = orderedGroups(result);
  groups.push_back(result.anything);
  for (const Dependence& group : groups)
    json[group.on] = {{"share_percent", kPercent * group.share},
                      {"interval_percent", intervalJson(group.lower, group.upper)}};
  return json;
}

Json parametersJson(const std::vector<NamedParameter>& parameters) {
  Json json = Json::object();
  for (const NamedParameter& parameter : parameters)
    json[parameter.symbol] = {
        {"value", parameter.value}, {"std", parameter.deviation}, {"unit", parameter.unit}};
  return json;
}

Json rivalJson(const Verdict& verdict, const Rival& rival) {
  Json json;
  json["label"] = hypothesisLabel(rival.hypothesis, verdict.simulation.robot);
  json["parameters"] = parametersJson(parametersOf(verdict, rival));
  json["relative_gain"] = rival.relative_gain;
  json["z"] = rival.z;
  json["log_likelihood_difference"] = rival.log_likelihood;
  json["log_likelihood_expected"] = rival.log_likelihood_expected;
  return json;
}

Json causeJson(const Verdict& verdict, std::size_t index) {
  const Cause& cause = verdict.causes[index];
  Json json;
  json["effect"] = cause.hypothesis.effect;
  json["joints"] = Json::array();
  for (const int joint : cause.hypothesis.joints)
    json["joints"].push_back(verdict.joints[static_cast<std::size_t>(joint)]);
  json["label"] = verdict.labels[index];
  json["parameters"] = parametersJson(parametersOf(verdict, cause));
  json["explained_percent"] = kPercent * cause.share;
  json["interval_percent"] = intervalJson(cause.lower, cause.upper);
  json["indistinguishable_from"] = equalLabels(verdict, cause);
  for (const Rival& rival : cause.equals) json["rivals"].push_back(rivalJson(verdict, rival));
  if (!cause.equals.empty())
    json["separated_by"] =
        separatingRecording(cause.hypothesis.effect, cause.equals.front().hypothesis.effect);
  if (cause.has_runner_up)
    json["runner_up"] = {{"label", hypothesisLabel(cause.runner_up, verdict.simulation.robot)},
                         {"relative_share", cause.runner_up_share}};
  return json;
}

}  // namespace

std::string causeText(const Verdict& verdict, std::size_t index) {
  const Cause& cause = verdict.causes[index];
  std::string text = verdict.labels[index] + ":";
  for (const NamedParameter& parameter : parametersOf(verdict, cause))
    text += " " + parameterText(parameter, "+-") + ",";
  text += format(" explains %.1f %% (%.1f..%.1f %%)", kPercent * cause.share,
                 kPercent * cause.lower, kPercent * cause.upper);
  if (cause.has_runner_up)
    text += format("; next best: %s (%.0f %% of it)",
                   hypothesisLabel(cause.runner_up, verdict.simulation.robot).c_str(),
                   kPercent * cause.runner_up_share);
  for (const Rival& rival : cause.equals) {
    text += std::string("\n    ") + relationTo(rival) + " " +
            hypothesisLabel(rival.hypothesis, verdict.simulation.robot) + ":";
    for (const NamedParameter& parameter : parametersOf(verdict, rival))
      text += " " + parameterText(parameter, "+-") + ",";
    text += " " + rivalText(rival);
  }
  if (!cause.equals.empty())
    text += format("\n    to tell: %s", separatingRecording(cause.hypothesis.effect,
                                                            cause.equals.front().hypothesis.effect)
                                            .c_str());
  return text;
}

std::string diagnosisText(const Verdict& verdict) {
  std::string text = causesText(verdict);
  text += unexplainedText(verdict) + "\n";
  text += verdict.has_kinematics
              ? format("\n  %-34s %7s %7s %7s   %7s\n", "", "RMS mm", "median", "p95", "deg")
              : "\n  RMS [rad or m]                    ";
  if (!verdict.has_kinematics) {
    for (const std::string& joint : verdict.joints) text += format(" %11s", joint.c_str());
    text += "\n";
  }
  text += errorsText(verdict, "simulation as given", verdict.before);
  if (verdict.aligned)
    text += errorsText(verdict, "registration and tool frame alone", verdict.after_alignment);
  text += errorsText(verdict, "all causes, motions held out", verdict.after);
  text += errorsText(verdict, "and what a process learns from that", verdict.after_learning);
  text += format("  gain %.1f %% (%.1f..%.1f %%)", kPercent * verdict.gain,
                 kPercent * verdict.gain_lower, kPercent * verdict.gain_upper);
  if (verdict.aligned)
    text += format(", from registration and tool frame on %.1f %% (%.1f..%.1f %%)",
                   kPercent * verdict.gain_from_alignment, kPercent * verdict.alignment_lower,
                   kPercent * verdict.alignment_upper);
  text += format("; a Gaussian process still learns %.1f %% (%.1f..%.1f %%) of what is left",
                 kPercent * verdict.learnable, kPercent * verdict.learnable_lower,
                 kPercent * verdict.learnable_upper);
  if (verdict.has_kinematics)
    text += format("; noise floor %.2f mm, %.2f deg RMS", kMillimetre * verdict.noise_floor,
                   kDegree * verdict.angle_floor);
  if (!verdict.slow_delay.empty()) {
    text += "\n  behind the command in slow motion:";
    for (std::size_t j = 0; j < verdict.slow_delay.size(); ++j)
      text += format("%s %s %.1f ms", j ? "," : "", verdict.joints[j].c_str(),
                     1e3 * verdict.slow_delay[j]);
    text += format("; one delay of everything: %.1f ms to first order", 1e3 * verdict.shown.delay);
  }
  text += "\n\nShare of the squared residual that can be predicted on motions held out:\n";
  text += dependenceText("before", verdict.shown);
  text += dependenceText("after", verdict.left);
  text += format(
      "\n%s: %d motions, %zu samples, %d folds; %zu hypotheses, %zu starts; %.1f s, seed "
      "%llu\n",
      verdict.recording.c_str(), verdict.motions, verdict.samples, verdict.folds,
      verdict.hypotheses, verdict.starts, verdict.seconds,
      static_cast<unsigned long long>(verdict.seed));
  if (verdict.stopped_at_most)
    text += format("no further cause was tried beside these %zu (--max-causes)\n",
                   verdict.causes.size());
  const Recording::Left& left = verdict.left_out;
  text += format(
      "left out: %zu of %zu commands (%zu no poses, %zu out of reach), %zu brought to a joint "
      "limit; of %zu observations "
      "%zu repeated, %zu impossible, %zu thinned out\n",
      left.not_a_command + left.unreachable, left.setpoints, left.not_a_command, left.unreachable,
      left.outside_limits, left.observations, left.repeated, left.impossible, left.thinned);
  return text;
}

std::string diagnosisJson(const Verdict& verdict) {
  Json json;
  json["causes"] = Json::array();
  for (std::size_t i = 0; i < verdict.causes.size(); ++i)
    json["causes"].push_back(causeJson(verdict, i));
  json["unexplained"] = {{"present", verdict.unexplained},
                         {"depends_on", verdict.depends_on},
                         {"rms_mm", kMillimetre * verdict.structure_position},
                         {"rms_deg", kDegree * verdict.structure_orientation},
                         {"share_percent", kPercent * verdict.left.anything.share}};
  if (!verdict.has_kinematics) {
    json["unexplained"].erase("rms_mm");
    json["unexplained"].erase("rms_deg");
    for (std::size_t j = 0; j < verdict.structure_joints.size(); ++j)
      json["unexplained"]["rms"][verdict.joints[j] + "_" + jointUnit(verdict, j)] =
          verdict.structure_joints[j];
  }
  json["before"] = errorsJson(verdict, verdict.before);
  json["after"] = errorsJson(verdict, verdict.after);
  if (verdict.aligned) json["after_alignment"] = errorsJson(verdict, verdict.after_alignment);
  json["gain_percent"] = kPercent * verdict.gain;
  json["gain_interval_percent"] = intervalJson(verdict.gain_lower, verdict.gain_upper);
  if (verdict.aligned) {
    json["gain_from_alignment_percent"] = kPercent * verdict.gain_from_alignment;
    json["gain_from_alignment_interval_percent"] =
        intervalJson(verdict.alignment_lower, verdict.alignment_upper);
  }
  json["learnable_percent"] = kPercent * verdict.learnable;
  json["learnable_interval_percent"] =
      intervalJson(verdict.learnable_lower, verdict.learnable_upper);
  json["after_learning"] = errorsJson(verdict, verdict.after_learning);
  if (verdict.has_kinematics) {
    json["noise_floor_mm"] = kMillimetre * verdict.noise_floor;
    json["noise_floor_deg"] = kDegree * verdict.angle_floor;
  } else {
    for (std::size_t j = 0; j < verdict.joint_floor.size(); ++j)
      json["noise_floor"][verdict.joints[j] + "_" + jointUnit(verdict, j)] = verdict.joint_floor[j];
  }
  if (!verdict.slow_delay.empty()) {
    json["delay"]["single_s"] = verdict.shown.delay;
    for (std::size_t j = 0; j < verdict.slow_delay.size(); ++j)
      json["delay"]["slow_motion"].push_back(
          {{"joint", verdict.joints[j]}, {"behind_s", verdict.slow_delay[j]}});
  }
  json["depends_on_before"] = dependenceJson(verdict.shown);
  json["depends_on_after"] = dependenceJson(verdict.left);
  const Recording::Left& left = verdict.left_out;
  json["data"] = {{"recording", verdict.recording},
                  {"motions", verdict.motions},
                  {"samples", verdict.samples},
                  {"folds", verdict.folds},
                  {"driven_by", verdict.source == DriveSource::kCommands ? "commands" : "encoders"},
                  {"encoders_observed", verdict.has_encoders},
                  {"hypotheses", verdict.hypotheses},
                  {"starts", verdict.starts},
                  {"commands", left.setpoints},
                  {"commands_not_a_pose", left.not_a_command},
                  {"commands_out_of_reach", left.unreachable},
                  {"commands_outside_limits", left.outside_limits},
                  {"observations", left.observations},
                  {"observations_repeated", left.repeated},
                  {"observations_impossible", left.impossible},
                  {"observations_thinned", left.thinned}};
  json["converged"] = verdict.converged;
  json["stopped_at_max_causes"] = verdict.stopped_at_most;
  json["seconds"] = verdict.seconds;
  json["seed"] = verdict.seed;
  return json.dump(1) + "\n";
}

}  // namespace raven_correction
