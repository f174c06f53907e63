// SPDX-License-Identifier: BSD-3-Clause
// What a report says of the run that made it: the command line, the inputs, the time. What the page
// looks like is the room `report`.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/report/run_record.h"

namespace raven_correction {

/// Remembers the words of the command line; runOffline() calls it first.
void setCommandLine(int argc, const char* const* argv);

/// "./run offline diagnose 'my session' --report r.html": can be pasted into a shell.
std::string commandLine();

/// Command, time (UTC) and checksums of all files of the inputs.
/// @throws InvalidInput  an input cannot be read
RunRecord recordRun(const std::vector<std::string>& inputs);

}  // namespace raven_correction
