// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/diagnose.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "raven_correction/diagnosis/blocks.h"
#include "raven_correction/diagnosis/learnable.h"
#include "raven_correction/diagnosis/noise_floor.h"
#include "raven_correction/error.h"
#include "raven_correction/geometry/statistics.h"

namespace raven_correction {
namespace {

constexpr double kLeastStructure = 0.05;  // of the squares of what is left: below it, noise [-]
constexpr double kLeastGroup = 0.03;      // and of one group of features [-]
constexpr double kBeyondNoise = 1.4;      // residual over noise floor: more is structure [-]
constexpr int kResamples = 1000;

std::vector<double> slowDelays(const SimulationConfig& simulation, std::size_t joints) {
  std::vector<double> delays(joints, 0.0);
  if (const Effect* const delay = simulation.find("command_delay"))
    for (double& sum : delays) sum += delay->parameters().front().value;
  if (const Effect* const lag = simulation.find("tracking_lag"))
    for (const EffectParameter& parameter : lag->parameters())
      delays[static_cast<std::size_t>(parameter.joint)] += parameter.value;
  return delays;
}

std::vector<bool> motionsOfFold(int motions, int folds, int fold) {
  std::vector<bool> use(static_cast<std::size_t>(motions), false);
  for (int m = fold; m < motions; m += folds) use[static_cast<std::size_t>(m)] = true;
  return use;
}

DiagnosisErrors errorsOf(const ResidualLayout& layout, const Eigen::VectorXd& residual, int folds,
                         bool has_kinematics) {
  DiagnosisErrors errors;
  errors.sizes = errorSizes(layout, residual);
  for (int fold = 0; has_kinematics && fold < folds; ++fold) {
    const ErrorSizes sizes =
        errorSizes(layout, residual, motionsOfFold(layout.motions, folds, fold));
    errors.fold_position_median.push_back(sizes.position_median);
    errors.fold_orientation_median.push_back(sizes.orientation_median);
  }
  return errors;
}

/// Sum of squares and number of samples of every motion and channel that counts.
struct Squares {
  Eigen::MatrixXd sum, count;  // channels x motions
};
Squares squaresOf(const ResidualLayout& layout, const Eigen::VectorXd& residual) {
  const auto channels = static_cast<Eigen::Index>(layout.channels.size());
  Squares squares{Eigen::MatrixXd::Zero(channels, layout.motions),
                  Eigen::MatrixXd::Zero(channels, layout.motions)};
  for (const ResidualBlock& block : layout.blocks) {
    const Channel& channel = layout.channels[static_cast<std::size_t>(block.channel)];
    squares.sum(block.channel, block.motion) +=
        residual.segment(block.offset, channel.size).squaredNorm();
    squares.count(block.channel, block.motion) += 1.0;
  }
  return squares;
}

struct Gain {
  double value = 0.0, lower = 0.0, upper = 0.0;
};

/// 1 - RMS ratio of position, or the mean of it over joints, with a bootstrap over motions.
Gain gainOf(const ResidualLayout& layout, const Eigen::VectorXd& before,
            const Eigen::VectorXd& after, std::uint64_t seed) {
  const Squares a = squaresOf(layout, before), b = squaresOf(layout, after);
  const auto gain = [&](const Eigen::VectorXd& weight) {
    double sum = 0.0;
    int channels = 0;
    for (std::size_t c = 0; c < layout.channels.size(); ++c) {
      const Channel& channel = layout.channels[c];
      if (channel.encoder || channel.name == "orientation") continue;
      const auto row = static_cast<Eigen::Index>(c);
      const double from = a.sum.row(row).dot(weight), to = b.sum.row(row).dot(weight);
      if (!(from > 0.0)) continue;
      sum += 1.0 - std::sqrt(to / from);
      ++channels;
    }
    return channels ? sum / channels : 0.0;
  };
  Gain result;
  result.value = gain(Eigen::VectorXd::Ones(layout.motions));
  std::vector<double> gains;
  bootstrapOverGroups(static_cast<std::size_t>(layout.motions), kResamples, seed,
                      [&](const std::vector<std::size_t>& drawn) {
                        Eigen::VectorXd weight = Eigen::VectorXd::Zero(layout.motions);
                        for (const std::size_t m : drawn)
                          weight(static_cast<Eigen::Index>(m)) += 1.0;
                        gains.push_back(gain(weight));
                      });
  const Interval interval = interval95(gains);
  result.lower = interval.lower;
  result.upper = interval.upper;
  return result;
}

bool isBeyondNoise(const ResidualLayout& layout, const Eigen::VectorXd& residual,
                   const Eigen::VectorXd& floor) {
  const Eigen::VectorXd scale = channelScales(layout, residual);
  for (std::size_t c = 0; c < layout.channels.size(); ++c) {
    const auto k = static_cast<Eigen::Index>(c);
    if (!layout.channels[c].encoder && floor(k) > 0.0 && scale(k) > kBeyondNoise * floor(k))
      return true;
  }
  return false;
}

bool isAlignment(const Cause& cause) {
  return cause.hypothesis.effect == "base_registration" || cause.hypothesis.effect == "tool_offset";
}

/// Registration and tool frame alone, fitted anew, on motions held out.
SimulatedResidual alignedResidual(const Recording& recording, const ResidualLayout& layout,
                                  const SimulationConfig& simulation, const Verdict& verdict) {
  EffectFitProblem problem;
  problem.recording = &recording;
  problem.layout = &layout;
  problem.simulation = simulation;
  std::vector<double> start;
  for (const Cause& cause : verdict.causes) {
    if (!isAlignment(cause)) continue;
    const auto& parameters = cause.hypothesis.parameters;
    problem.parameters.insert(problem.parameters.end(), parameters.begin(), parameters.end());
    start.insert(start.end(), cause.values.data(), cause.values.data() + cause.values.size());
  }
  problem.start =
      Eigen::Map<Eigen::VectorXd>(start.data(), static_cast<Eigen::Index>(start.size()));
  problem.scales = channelScales(
      layout,
      residuals(recording, layout, withValues(simulation, problem.parameters, problem.start)));
  const EffectFit fit = fitEffects(problem);
  SimulatedResidual aligned;
  aligned.residual = heldOutResiduals(problem, fit, verdict.folds, &aligned.simulated);
  return aligned;
}

/// @param beyond_noise  what is left is larger than the noise from sample to sample: it is
/// structure,
///        whether or not the features predict it (a table that sways, a joint that rings)
void judgeWhatIsLeft(bool beyond_noise, Verdict& verdict) {
  const Dependence& anything = verdict.left.anything;
  verdict.predicted = anything.lower > 0.0 && anything.share > kLeastStructure;
  verdict.unexplained = verdict.predicted || beyond_noise;
  if (!verdict.unexplained) return;
  std::vector<Dependence> groups = verdict.left.groups;
  std::stable_sort(groups.begin(), groups.end(),
                   [](const Dependence& a, const Dependence& b) { return a.share > b.share; });
  for (const Dependence& group : groups)
    if (group.lower > 0.0 && group.share > kLeastGroup) verdict.depends_on.push_back(group.on);
}

}  // namespace

Verdict diagnose(const Dataset& dataset, const SimulationConfig& simulation,
                 const std::vector<bool>& prismatic, const DiagnosisOptions& options,
                 const DiagnosisProgress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  const bool joint_data = isJointData(dataset);
  Recording recording = joint_data ? makeJointRecording(dataset, prismatic, options.recording)
                                   : makeRecording(dataset, simulation.robot, options.recording);
  cutIntoBlocks(options.least_motions, recording);
  SimulationConfig base = simulation;
  if (joint_data) {
    base = SimulationConfig();
    base.name = dataset.name;
    base.robot = recording.robot;
    base.setpoints = simulation.setpoints;
  }
  // Encoders are sampled from a smooth motion: between two samples the motor did not stand still.
  if (recording.source == DriveSource::kEncoders) base.setpoints = SetpointMode::kLinear;

  const ResidualLayout layout = residualLayout(recording);
  SelectionResult selection = selectCauses(recording, layout, base, options.selection, progress);

  Verdict verdict;
  verdict.recording = dataset.name;
  verdict.has_kinematics = recording.has_kinematics;
  verdict.has_encoders = recording.has_encoders;
  verdict.source = recording.source;
  verdict.joints = recording.robot.jointNames();
  for (const Joint& joint : recording.robot.joints())
    verdict.prismatic.push_back(joint.type == JointType::kPrismatic);
  verdict.left_out = recording.left_out;
  verdict.motions = layout.motions;
  verdict.folds = options.selection.folds;
  verdict.hypotheses = selection.hypotheses;
  verdict.starts = selection.starts;
  verdict.converged = selection.converged;
  verdict.stopped_at_most = selection.stopped_at_most;
  verdict.seed = options.selection.seed;
  verdict.causes = std::move(selection.causes);
  for (const Cause& cause : verdict.causes)
    verdict.labels.push_back(hypothesisLabel(cause.hypothesis, recording.robot));
  verdict.simulation = std::move(selection.simulation);

  const Eigen::VectorXd& before = selection.nominal_residual;
  const Eigen::VectorXd& after = selection.held_out_residual;
  verdict.before = errorsOf(layout, before, verdict.folds, recording.has_kinematics);
  verdict.after = errorsOf(layout, after, verdict.folds, recording.has_kinematics);
  verdict.samples = verdict.before.sizes.samples;
  const Gain gain = gainOf(layout, before, after, verdict.seed);
  verdict.gain = gain.value;
  verdict.gain_lower = gain.lower;
  verdict.gain_upper = gain.upper;
  verdict.aligned = std::any_of(verdict.causes.begin(), verdict.causes.end(), isAlignment);
  SimulatedResidual aligned;
  if (verdict.aligned) {
    aligned = alignedResidual(recording, layout, base, verdict);
    verdict.after_alignment = errorsOf(layout, aligned.residual, verdict.folds, true);
    const Gain from = gainOf(layout, aligned.residual, after, verdict.seed);
    verdict.gain_from_alignment = from.value;
    verdict.alignment_lower = from.lower;
    verdict.alignment_upper = from.upper;
  }

  SimulatedSamples given, extended;
  residuals(recording, layout, base, &given);
  if (recording.source == DriveSource::kCommands)
    verdict.slow_delay = slowDelays(verdict.simulation, verdict.joints.size());
  verdict.shown = residualDependence(recording, layout, before, given.joints, given, verdict.folds,
                                     verdict.seed);
  verdict.left = residualDependence(recording, layout, after, given.joints, selection.held_out,
                                    verdict.folds, verdict.seed);
  verdict.figures = residualSamples(recording, layout, {before, std::move(given)}, aligned,
                                    {after, std::move(selection.held_out)});
  if (progress) progress("learning from what is left", 0.98);
  residuals(recording, layout, verdict.simulation, &extended);
  const Eigen::VectorXd learnt =
      withoutLearnable(recording, layout, after, extended.joints, verdict.folds, verdict.seed);
  const Gain learnable = gainOf(layout, after, learnt, verdict.seed);
  verdict.learnable = learnable.value;
  verdict.learnable_lower = learnable.lower;
  verdict.learnable_upper = learnable.upper;
  verdict.after_learning = errorsOf(layout, learnt, verdict.folds, recording.has_kinematics);

  const Eigen::VectorXd floor = noiseFloor(recording, verdict.simulation);
  const Eigen::VectorXd scales = channelScales(layout, after);
  judgeWhatIsLeft(isBeyondNoise(layout, after, floor), verdict);
  for (std::size_t c = 0; c < layout.channels.size(); ++c) {
    const double told = floor(static_cast<Eigen::Index>(c));
    const double value = std::isnan(told) ? 0.0 : told;
    const double scale = scales(static_cast<Eigen::Index>(c));
    const double beyond = std::sqrt(std::max(0.0, scale * scale - value * value));
    if (layout.channels[c].encoder) continue;
    if (!recording.has_kinematics) {
      verdict.joint_floor.push_back(value);
      verdict.structure_joints.push_back(beyond);
      continue;
    }
    const bool position = layout.channels[c].unit == "m";
    (position ? verdict.noise_floor : verdict.angle_floor) = std::sqrt(3.0) * value;
    (position ? verdict.structure_position : verdict.structure_orientation) =
        std::sqrt(3.0) * beyond;
  }
  verdict.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return verdict;
}

}  // namespace raven_correction
