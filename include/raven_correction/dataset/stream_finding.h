// SPDX-License-Identifier: BSD-3-Clause
// What checks say of streams: of their samples (stream_check.h), and of the topics they should come
// on (topic_check.h).
#pragma once

#include <string>
#include <vector>

namespace raven_correction {

/// What is wrong with a stream, for people and programs.
struct StreamFinding {
  enum class Severity {
    kWarning,  ///< worth a look
    kError,    ///< what is learnt from this, or corrected with it, cannot be trusted
  };
  Severity severity = Severity::kWarning;
  std::string stream;    ///< name of the topic, or of the stream of the data set
  std::string what;      ///< "missing", "type", "stamps", "order", "values", "frame", "units",
                         ///< "rate", "gaps", "repeated", "clock", "arm", "distance", "motion",
                         ///< "homing"
  std::string measured;  ///< what it is, with its unit
  std::string limit;     ///< what it should be
  std::string remedy;    ///< what to do
};
/// "error: servo_cp: units: MEASURED (LIMIT); REMEDY".
std::string toText(const StreamFinding& finding);
bool anyError(const std::vector<StreamFinding>& findings) noexcept;
/// @param source     where the streams are from: bags, directories
/// @param exception  how to go on in spite of an error
/// @throws InvalidInput  there is an error among them; the text has the source, all of them, and
/// the
///         exception
void refuseErrors(const std::string& source, const std::vector<StreamFinding>& findings,
                  const std::string& exception);

}  // namespace raven_correction
