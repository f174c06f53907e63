// SPDX-License-Identifier: BSD-3-Clause
// The whole diagnosis: what the simulation gets wrong about a recording, which physical causes the
// recording supports, what they gain on motions that their parameters were not fitted to, and what
// is left. Its parts are recording.h, residual.h, selection.h and dependence.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raven_correction/diagnosis/dependence.h"
#include "raven_correction/diagnosis/residual_samples.h"
#include "raven_correction/diagnosis/selection.h"

namespace raven_correction {

struct DiagnosisOptions {
  RecordingOptions recording;
  SelectionOptions selection;
  /// A recording of fewer motions is cut into about this many blocks of time.
  int least_motions = 10;
};

/// Errors of one simulation of the recording.
struct DiagnosisErrors {
  ErrorSizes sizes;
  std::vector<double> fold_position_median;     ///< [m]; empty for joint data
  std::vector<double> fold_orientation_median;  ///< [rad]
};

struct Verdict {
  std::string recording;  ///< its name
  bool has_kinematics = true;
  bool has_encoders = false;
  DriveSource source = DriveSource::kCommands;
  std::vector<std::string> joints;  ///< names, in order
  std::vector<bool> prismatic;      ///< one per joint
  Recording::Left left_out;
  int motions = 0, folds = 0;
  std::size_t samples = 0, hypotheses = 0, starts = 0;
  std::uint64_t seed = 0;
  double seconds = 0.0;

  std::vector<Cause> causes;
  bool converged = true;            ///< the last fit of all causes
  bool stopped_at_most = false;     ///< max_causes were in, so no further one was tried
  std::vector<std::string> labels;  ///< of the causes, for people
  SimulationConfig simulation;      ///< extended with the causes
  DiagnosisErrors before;           ///< of the simulation that was given
  /// Of the extended one; every motion by parameters fitted without its fold (heldOutResiduals()).
  /// Which causes these are was chosen with all motions in view, and so were the shapes that no
  /// gradient improves (Hypothesis::fixed_shapes: the instant of a shift).
  DiagnosisErrors after;
  /// 1 - RMS after / RMS before, of position (joint data: mean over joints), with its 95 % interval
  /// by bootstrap over motions [-].
  double gain = 0.0, gain_lower = 0.0, gain_upper = 0.0;
  /// Where base registration or tool offset are among the causes: the errors with these alone,
  /// which say where things are rather than how the robot errs, and the gain from there.
  bool aligned = false;
  DiagnosisErrors after_alignment;
  double gain_from_alignment = 0.0, alignment_lower = 0.0, alignment_upper = 0.0;

  /// What a Gaussian process still learns from what is left (learnable.h): 1 - RMS with it / RMS
  /// after, as `gain`, on motions held out. Below 0: there is nothing to learn.
  double learnable = 0.0, learnable_lower = 0.0, learnable_upper = 0.0;
  DiagnosisErrors after_learning;  ///< what is left then

  /// How far each joint is behind its command in a slow motion, by the extended simulation: the
  /// delay of the commands and the time constant of the joint's lag [s]. Empty where encoders drive
  /// it. The best single delay of a recording is a mean of these (DependenceResult::delay, to first
  /// order).
  std::vector<double> slow_delay;

  DependenceResult shown;    ///< what the residual before depends on
  DependenceResult left;     ///< what the residual after depends on
  ResidualSamples figures;   ///< the residual before and after, sample by sample
  bool unexplained = false;  ///< structure is left that the catalogue does not explain
  bool predicted = false;    ///< position, direction, speed, load or time predict a part of it
  /// Size of what is left beyond the noise floor: robust RMS length [m], angle [rad], or per joint.
  double structure_position = 0.0, structure_orientation = 0.0;
  std::vector<double> structure_joints;
  /// Of `left`, those beyond doubt; empty where what is left is larger than noise, but nothing that
  /// was tried predicts it.
  std::vector<std::string> depends_on;
  /// Noise from frame to frame (noiseFloor()); 0 where no frames tell it.
  double noise_floor = 0.0;         ///< RMS length of position noise [m]; joint data: 0
  double angle_floor = 0.0;         ///< RMS angle of orientation noise [rad]; joint data: 0
  std::vector<double> joint_floor;  ///< joint data: standard deviation of each joint [rad or m]
};

/// @param simulation  what is believed of the robot; of joint data only whether set-points are held
/// @param prismatic   joint data: which joints are in metres
/// @throws InvalidInput  see makeRecording(), makeJointRecording(), selectCauses()
Verdict diagnose(const Dataset& dataset, const SimulationConfig& simulation,
                 const std::vector<bool>& prismatic, const DiagnosisOptions& options,
                 const DiagnosisProgress& progress = {});

}  // namespace raven_correction
