// SPDX-License-Identifier: BSD-3-Clause
// The numbers of a report as a table that spreadsheets and statistics read. They are made elsewhere
// in the room, as JSON.
#pragma once

#include <string>

namespace raven_correction {

/// The numbers and words of a JSON object as CSV (RFC 4180, first line: names). Names are paths:
/// "after.position_rms_mm", "causes.0.explained_percent". Where the object has "rows", an array of
/// objects, each of these is a line, and what else the object has stands in every line; otherwise
/// there is one line per number, `quantity,value`. null is an empty field.
/// @throws InvalidInput  not a JSON object
std::string csvOfJson(const std::string& json);

}  // namespace raven_correction
