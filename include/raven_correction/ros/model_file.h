// SPDX-License-Identifier: BSD-3-Clause
// The learnt correction as a message and as a file: a bag with that one message. Every double
// survives bit for bit. The message type is raven_correction::CorrectionModel, the core's plain
// data raven_correction::Correction.
#pragma once

#include <raven_correction/CorrectionModel.h>

#include <string>

#include "raven_correction/correction/model.h"

namespace raven_correction {

CorrectionModel modelToMsg(const Correction& model);
/// @throws InvalidInput  another format number, sizes that do not fit together, unknown names
Correction modelFromMsg(const CorrectionModel& msg);

/// Writes under another name first and renames, so that an old file is never half replaced.
/// @throws InvalidInput  the file exists and may not be overwritten, or cannot be written
void writeModelFile(const Correction& model, const std::string& file, bool overwrite);
/// @throws InvalidInput  no such file, not a bag, cut off, without a model, or see modelFromMsg()
Correction readModelFile(const std::string& file);

}  // namespace raven_correction
