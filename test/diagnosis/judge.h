// SPDX-License-Identifier: BSD-3-Clause
// Compares a verdict with what the plant hid: was the cause named, how large is it said to be, and
// is the gain what the truth would give? For the tests and for the benchmark.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "plant/hidden_effect.h"
#include "raven_correction/diagnosis/diagnose.h"

namespace raven_correction {

inline bool isCause(const Hypothesis& hypothesis, const plant::HiddenEffect& truth,
                    const KinematicChain& robot) {
  if (hypothesis.effect != truth.effect || hypothesis.joints != truth.joints) return false;
  if (truth.effect != "link_geometry") return true;
  // An angle or one of two lengths of the same row: the symbol counts, too.
  SimulationConfig nominal;
  nominal.robot = robot;
  const std::string symbol = parameterOf(nominal, hypothesis.parameters.front()).symbol;
  return truth.parameters.count(symbol) && truth.parameters.at(symbol) != 0.0;
}

/// As the cause itself or among those that cannot be told from it.
inline bool names(const Cause& cause, const plant::HiddenEffect& truth,
                  const KinematicChain& robot) {
  return isCause(cause.hypothesis, truth, robot) ||
         std::any_of(cause.equals.begin(), cause.equals.end(),
                     [&](const Rival& equal) { return isCause(equal.hypothesis, truth, robot); });
}

/// Whether every amplitude is within 15 % of the truth or two standard deviations. Those of a truth
/// that has several (a pose) are compared as a whole: their difference within 15 % of their size,
/// or each within two deviations.
inline bool isSizeRight(const Hypothesis& hypothesis, const Eigen::VectorXd& values,
                        const Eigen::VectorXd& deviations, const plant::HiddenEffect& truth,
                        const SimulationConfig& simulation) {
  bool within_deviations = true;
  double difference = 0.0, size = 0.0;
  for (std::size_t k = 0; k < hypothesis.amplitudes(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    const std::string symbol = parameterOf(simulation, hypothesis.parameters[k]).symbol;
    const auto found = truth.parameters.find(symbol);
    const double is = found == truth.parameters.end() ? 0.0 : found->second;
    // Metres count as at an arm's length of 50 mm, where poses mix them with radians.
    const bool length =
        hypothesis.amplitudes() > 1 && (symbol == "x" || symbol == "y" || symbol == "z");
    const double scale = length ? 20.0 : 1.0;
    difference += std::pow(scale * (values(at) - is), 2);
    size += std::pow(scale * is, 2);
    within_deviations &= std::abs(values(at) - is) <= 2.0 * deviations(at);
  }
  return within_deviations || std::sqrt(difference) <= 0.15 * std::sqrt(size);
}

struct Judgement {
  bool named = false;       ///< as a cause, or among those that cannot be told from one
  bool itself = false;      ///< as a cause
  bool first = false;       ///< as the largest one
  bool size_right = false;  ///< of the cause, or of the equal that it is
};

inline Judgement judge(const Verdict& verdict, const plant::HiddenEffect& truth) {
  Judgement judgement;
  const KinematicChain& robot = verdict.simulation.robot;
  for (std::size_t i = 0; i < verdict.causes.size(); ++i) {
    const Cause& cause = verdict.causes[i];
    judgement.named |= names(cause, truth, robot);
    if (isCause(cause.hypothesis, truth, robot)) {
      judgement.itself = true;
      judgement.first |= i == 0;
      judgement.size_right |=
          isSizeRight(cause.hypothesis, cause.values, cause.deviations, truth, verdict.simulation);
    }
    for (const Rival& equal : cause.equals)
      judgement.size_right |=
          isCause(equal.hypothesis, truth, robot) &&
          isSizeRight(equal.hypothesis, equal.values, equal.deviations, truth, verdict.simulation);
  }
  return judgement;
}

/// The simulation with the truth in it.
inline SimulationConfig withTruth(const SimulationConfig& simulation,
                                  const std::vector<plant::HiddenEffect>& truth) {
  SimulationConfig result = simulation;
  for (const plant::HiddenEffect& hidden : truth) {
    SimulationConfig probe;
    probe.robot = simulation.robot;
    for (int index = 0;; ++index) {
      EffectParameter parameter;
      try {
        parameter = parameterOf(probe, {hidden.effect, index});
      } catch (const std::exception&) {
        break;
      }
      const auto found = hidden.parameters.find(parameter.symbol);
      const bool mine = hidden.joints.empty() ||
                        (parameter.joint == hidden.joints[0] &&
                         (hidden.joints.size() < 2 || parameter.source == hidden.joints[1]));
      if (found == hidden.parameters.end() || !mine) continue;
      result =
          withValues(result, {{hidden.effect, index}}, Eigen::VectorXd::Constant(1, found->second));
    }
  }
  return result;
}

/// 1 - median after / median before of the positions, or where the truth turns rather than moves
/// the tool, of the orientations, on the session itself: what the true parameters gain, and the
/// verdict's.
struct TrueGain {
  double truth = 0.0, verdict = 0.0;
};
inline TrueGain compareGains(const Verdict& verdict, const Dataset& dataset,
                             const SimulationConfig& nominal,
                             const std::vector<plant::HiddenEffect>& truth,
                             const RecordingOptions& options) {
  const Recording recording = makeRecording(dataset, nominal.robot, options);
  const ResidualLayout layout = residualLayout(recording);
  const ErrorSizes before = errorSizes(layout, residuals(recording, layout, nominal));
  const ErrorSizes with =
      errorSizes(layout, residuals(recording, layout, withTruth(nominal, truth)));
  const ErrorSizes found = errorSizes(layout, residuals(recording, layout, verdict.simulation));
  double mm = 0.0, deg = 0.0;
  for (const plant::HiddenEffect& hidden : truth) {
    mm += hidden.size_mm;
    deg += hidden.size_deg;
  }
  // Medians: a few percent of the orientations are wrong by tens of degrees whatever is done.
  if (mm / 0.1 >= deg / 0.3)
    return {1.0 - with.position_median / before.position_median,
            1.0 - found.position_median / before.position_median};
  return {1.0 - with.orientation_median / before.orientation_median,
          1.0 - found.orientation_median / before.orientation_median};
}

}  // namespace raven_correction
