// SPDX-License-Identifier: BSD-3-Clause
// Blocks of time: a recording of too few motions to hold any out is cut into them, and none of it
// is lost. Where motions come from is recording.h.
#pragma once

#include "raven_correction/diagnosis/recording.h"

namespace raven_correction {

/// Cuts every motion into blocks of equal time where there are fewer than `least`, so that about as
/// many become of them. Each block goes on where the one before ends (Recording::Motion::carried),
/// so residuals() of the blocks are those of the whole, in the same order. A block that nothing was
/// seen in is none: what was commanded in it is the beginning of the next one, or the end of the
/// last.
/// @param recording  motions with at least one set-point and one observation each
void cutIntoBlocks(int least, Recording& recording);

}  // namespace raven_correction
