// SPDX-License-Identifier: BSD-3-Clause
// What `offline diagnose` and the node diagnoser share: a request checked against its data set, the
// diagnosis, a name for the extended simulation, and the verdict as a message.
#pragma once

#include <raven_correction/DiagnosisVerdict.h>

#include <string>
#include <vector>

#include "raven_correction/diagnosis/diagnose.h"

namespace raven_correction {

struct DiagnosisJob {
  std::string from = "commands";       ///< or encoders
  bool ignore_encoders = false;        ///< encoder streams are no observations
  std::vector<std::string> prismatic;  ///< joint data: joints in metres beside those that say so
  /// Leave out the trajectories that a trainer validates models on (splitForValidation()), so that
  /// a model with the extended simulation as its mean can be judged there.
  bool leave_out_validation = false;
  std::string output;        ///< extended simulation file that shall be written, or empty
  DiagnosisOptions options;  ///< `recording.source` and `use_encoders` come from above
};

/// The simulation of the verdict has a name and a description, to be written, and says what it was
/// fitted to.
/// @throws InvalidInput  joint data with an output file or driven by encoders, a joint that is not
///         there, or see diagnose()
Verdict runDiagnosis(const Dataset& dataset, const SimulationConfig& simulation,
                     const DiagnosisJob& job, const DiagnosisProgress& progress);

/// Everything but header.stamp and `file`.
/// @param frame       of the poses of the data set
/// @param simulation  name of the one that was given
DiagnosisVerdict verdictToMsg(const Verdict& verdict, const std::string& frame,
                              const std::string& simulation);

/// "backlash of elbow (83 %) and command_delay (40 %); position RMS 5.3 mm to 1.2 mm on motions
/// held out, gain 77 % (71..82 %)", or that nothing is claimed.
std::string verdictSentence(const Verdict& verdict);

}  // namespace raven_correction
