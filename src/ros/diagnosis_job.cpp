// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/diagnosis_job.h"

#include <algorithm>
#include <limits>

#include "raven_correction/diagnosis/separating_recording.h"
#include "raven_correction/error.h"
#include "raven_correction/evaluation/validated_training.h"

namespace raven_correction {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Which joints of a joint recording are in metres: as the data set or the user says.
std::vector<bool> prismaticJoints(const Dataset& dataset, const std::vector<std::string>& named) {
  std::vector<std::string> names;
  for (const Trajectory& trajectory : dataset.trajectories)
    if (names.empty()) names = trajectory.joint_commands.names;
  for (const std::string& name : named)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw InvalidInput(
          format("prismatic joint %s: the recording has no such joint", name.c_str()));
  std::vector<bool> prismatic;
  for (const std::string& name : names) {
    const auto unit = dataset.joint_units.find(name);
    prismatic.push_back((unit != dataset.joint_units.end() && unit->second == "m") ||
                        std::find(named.begin(), named.end(), name) != named.end());
  }
  return prismatic;
}

ResidualSizes sizesToMsg(const Verdict& verdict, const DiagnosisErrors& errors) {
  const ErrorSizes& sizes = errors.sizes;
  const auto pose = [&](double value) { return verdict.has_kinematics ? value : kNan; };
  ResidualSizes msg;
  msg.position_rms = pose(sizes.position_rms);
  msg.position_median = pose(sizes.position_median);
  msg.position_p95 = pose(sizes.position_p95);
  msg.orientation_rms = pose(sizes.orientation_rms);
  msg.orientation_median = pose(sizes.orientation_median);
  msg.joint_rms = sizes.joint_rms;
  msg.joint_median = sizes.joint_median;
  msg.joint_p95 = sizes.joint_p95;
  return msg;
}

std::vector<DiagnosisParameter> parametersToMsg(const Verdict& verdict,
                                                const Hypothesis& hypothesis,
                                                const Eigen::VectorXd& values,
                                                const Eigen::VectorXd& deviations) {
  const std::vector<std::string> names = parameterNames(hypothesis, verdict.simulation.robot);
  std::vector<DiagnosisParameter> all;
  for (std::size_t i = 0; i < hypothesis.parameters.size(); ++i) {
    DiagnosisParameter msg;
    msg.name = names[i];
    msg.value = values(static_cast<Eigen::Index>(i));
    msg.deviation = deviations(static_cast<Eigen::Index>(i));
    msg.unit = parameterOf(verdict.simulation, hypothesis.parameters[i]).unit;
    all.push_back(msg);
  }
  return all;
}

DiagnosisRival rivalToMsg(const Verdict& verdict, const Rival& rival) {
  DiagnosisRival msg;
  msg.label = hypothesisLabel(rival.hypothesis, verdict.simulation.robot);
  msg.parameters = parametersToMsg(verdict, rival.hypothesis, rival.values, rival.deviations);
  msg.relative_gain = rival.relative_gain;
  msg.z = rival.z;
  msg.log_likelihood = rival.log_likelihood;
  msg.log_likelihood_expected = rival.log_likelihood_expected;
  return msg;
}

DiagnosisCause causeToMsg(const Verdict& verdict, std::size_t index) {
  const Cause& cause = verdict.causes[index];
  const KinematicChain& robot = verdict.simulation.robot;
  DiagnosisCause msg;
  msg.label = verdict.labels[index];
  msg.effect = cause.hypothesis.effect;
  for (const int joint : cause.hypothesis.joints)
    msg.joints.push_back(verdict.joints[static_cast<std::size_t>(joint)]);
  msg.parameters = parametersToMsg(verdict, cause.hypothesis, cause.values, cause.deviations);
  msg.share = cause.share;
  msg.share_lower = cause.lower;
  msg.share_upper = cause.upper;
  for (const Rival& rival : cause.equals) msg.equals.push_back(rivalToMsg(verdict, rival));
  if (!cause.equals.empty())
    msg.separated_by =
        separatingRecording(cause.hypothesis.effect, cause.equals.front().hypothesis.effect);
  if (cause.has_runner_up) {
    msg.runner_up = hypothesisLabel(cause.runner_up, robot);
    msg.runner_up_share = cause.runner_up_share;
  }
  return msg;
}

}  // namespace

Verdict runDiagnosis(const Dataset& all, const SimulationConfig& simulation,
                     const DiagnosisJob& job, const DiagnosisProgress& progress) {
  const Dataset dataset = job.leave_out_validation ? splitForValidation(all).training : all;
  if (isJointData(dataset) && !job.output.empty())
    throw InvalidInput(format("%s: joint data has no robot to simulate; ask for no simulation file",
                              job.output.c_str()));
  if (isJointData(dataset) && job.from == "encoders")
    throw InvalidInput("driven by encoders: joint data has commands and observations only");
  DiagnosisOptions options = job.options;
  options.recording.source =
      job.from == "encoders" ? DriveSource::kEncoders : DriveSource::kCommands;
  options.recording.use_encoders = !job.ignore_encoders;
  Verdict verdict =
      diagnose(dataset, simulation, prismaticJoints(dataset, job.prismatic), options, progress);
  verdict.simulation.name = simulation.name + "_extended";
  std::vector<double>& fitted_to = verdict.simulation.fitted_to;  // those of before are in it
  for (const Trajectory& trajectory : dataset.trajectories) fitted_to.push_back(trajectory.start());
  std::sort(fitted_to.begin(), fitted_to.end());
  fitted_to.erase(std::unique(fitted_to.begin(), fitted_to.end()), fitted_to.end());
  verdict.simulation.description = "extended by what the diagnosis of " + dataset.name + " found";
  return verdict;
}

DiagnosisVerdict verdictToMsg(const Verdict& verdict, const std::string& frame,
                              const std::string& simulation) {
  const auto pose = [&](double value) { return verdict.has_kinematics ? value : kNan; };
  DiagnosisVerdict msg;
  if (verdict.has_kinematics) msg.header.frame_id = frame;
  msg.recording = verdict.recording;
  msg.simulation = simulation;
  msg.driven_by = verdict.source == DriveSource::kCommands ? "commands" : "encoders";
  msg.kinematics = verdict.has_kinematics;
  msg.encoders_observed = verdict.has_encoders;
  msg.joints = verdict.joints;
  for (const bool prismatic : verdict.prismatic)
    msg.joint_units.emplace_back(prismatic ? "m" : "rad");
  msg.motions = static_cast<std::uint32_t>(verdict.motions);
  msg.samples = static_cast<std::uint32_t>(verdict.samples);
  msg.folds = static_cast<std::uint32_t>(verdict.folds);
  msg.hypotheses = static_cast<std::uint32_t>(verdict.hypotheses);
  msg.stopped_at_max_causes = verdict.stopped_at_most;
  for (std::size_t i = 0; i < verdict.causes.size(); ++i)
    msg.causes.push_back(causeToMsg(verdict, i));
  msg.before = sizesToMsg(verdict, verdict.before);
  msg.aligned = verdict.aligned;
  msg.alignment = sizesToMsg(verdict, verdict.after_alignment);
  msg.after = sizesToMsg(verdict, verdict.after);
  msg.gain = verdict.gain;
  msg.gain_lower = verdict.gain_lower;
  msg.gain_upper = verdict.gain_upper;
  msg.gain_from_alignment = verdict.aligned ? verdict.gain_from_alignment : kNan;
  msg.learnable = verdict.learnable;
  msg.learnable_lower = verdict.learnable_lower;
  msg.learnable_upper = verdict.learnable_upper;
  msg.unexplained = verdict.unexplained;
  msg.depends_on = verdict.depends_on;
  msg.structure_position = pose(verdict.structure_position);
  msg.structure_orientation = pose(verdict.structure_orientation);
  msg.structure_joints = verdict.structure_joints;
  msg.noise_position = pose(verdict.noise_floor);
  msg.noise_orientation = pose(verdict.angle_floor);
  msg.noise_joints = verdict.joint_floor;
  msg.seed = verdict.seed;
  msg.seconds = verdict.seconds;
  return msg;
}

std::string verdictSentence(const Verdict& verdict) {
  constexpr double kPercent = 100.0, kMillimetre = 1e3;
  std::string text;
  for (std::size_t i = 0; i < verdict.causes.size(); ++i)
    text += (i == 0                           ? ""
             : i + 1 == verdict.causes.size() ? " and "
                                              : ", ") +
            verdict.labels[i] + format(" (%.0f %%)", kPercent * verdict.causes[i].share);
  if (verdict.causes.empty())
    text = "nothing is claimed: no cause in the catalogue predicts motions held out";
  if (verdict.has_kinematics)
    text += format("; position RMS %.2f mm to %.2f mm on motions held out",
                   kMillimetre * verdict.before.sizes.position_rms,
                   kMillimetre * verdict.after.sizes.position_rms);
  return text + format("%s gain %.0f %% (%.0f..%.0f %%)", verdict.has_kinematics ? "," : ";",
                       kPercent * verdict.gain, kPercent * verdict.gain_lower,
                       kPercent * verdict.gain_upper);
}

}  // namespace raven_correction
