// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis_words.h"

#include "raven_correction/error.h"
#include "report_json.h"

namespace raven_correction {

namespace {

std::vector<NamedParameter> named(const Verdict& verdict, const Hypothesis& hypothesis,
                                  const Eigen::VectorXd& values,
                                  const Eigen::VectorXd& deviations) {
  std::vector<NamedParameter> parameters;
  const std::vector<std::string> names = parameterNames(hypothesis, verdict.simulation.robot);
  for (std::size_t i = 0; i < hypothesis.parameters.size(); ++i) {
    const std::string unit = parameterOf(verdict.simulation, hypothesis.parameters[i]).unit;
    const auto k = static_cast<Eigen::Index>(i);
    parameters.push_back({names[i], unit, values(k), deviations(k)});
  }
  return parameters;
}

}  // namespace

std::vector<NamedParameter> parametersOf(const Verdict& verdict, const Cause& cause) {
  return named(verdict, cause.hypothesis, cause.values, cause.deviations);
}

std::vector<NamedParameter> parametersOf(const Verdict& verdict, const Rival& rival) {
  return named(verdict, rival.hypothesis, rival.values, rival.deviations);
}

std::string parameterText(const NamedParameter& parameter, const char* plus_minus) {
  std::string text = format("%s = %.4g", parameter.symbol.c_str(), parameter.value);
  if (parameter.deviation > 0.0) text += format(" %s %.2g", plus_minus, parameter.deviation);
  return parameter.unit.empty() || parameter.unit == "-" ? text : text + " " + parameter.unit;
}

std::string joined(const std::vector<std::string>& words, const char* last) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? std::string(" ") + last + " " : ", ") + words[i];
  return text;
}

std::vector<std::string> equalLabels(const Verdict& verdict, const Cause& cause) {
  std::vector<std::string> labels;
  for (const Rival& equal : cause.equals)
    labels.push_back(hypothesisLabel(equal.hypothesis, verdict.simulation.robot));
  return labels;
}

const char* relationTo(const Rival& rival) {
  return rival.isAhead() ? "the held-out motions speak rather for" : "cannot be told here from";
}

std::string rivalText(const Rival& rival) {
  return format(
      "%.0f %% of its gain, log likelihood %.2g %s (z %.1f); were the cause the truth, this "
      "recording "
      "would show %.2g on average",
      kPercent * rival.relative_gain, std::abs(rival.log_likelihood),
      rival.log_likelihood < 0.0 ? "higher" : "lower", rival.z, rival.log_likelihood_expected);
}

const char* jointUnit(const Verdict& verdict, std::size_t joint) {
  return verdict.prismatic[joint] ? "m" : "rad";
}

std::vector<Dependence> orderedGroups(const DependenceResult& result) {
  std::vector<Dependence> groups;
  if (!result.on_delay.on.empty()) groups.push_back(result.on_delay);
  groups.insert(groups.end(), result.groups.begin(), result.groups.end());
  return groups;
}

std::string unexplainedText(const Verdict& verdict) {
  if (!verdict.unexplained) return "What is left has no structure that could be predicted.";
  std::string text = "Structure is left that no cause in the catalogue explains";
  if (!verdict.predicted)
    text += ": it is larger than the noise, but nothing that was tried predicts it";
  else if (verdict.depends_on.empty())
    text += ": several things together predict a part of it";
  else
    text += ": it depends on " + joined(verdict.depends_on, "and");
  if (verdict.has_kinematics)
    text +=
        format(" (%.2f mm, %.2f deg beyond the noise)", kMillimetre * verdict.structure_position,
               kDegree * verdict.structure_orientation);
  return text + ".";
}

}  // namespace raven_correction
