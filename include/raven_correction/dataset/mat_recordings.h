// SPDX-License-Identifier: BSD-3-Clause
// The recordings that the authors of the paper released: one MATLAB file per motion. Data sets of
// this package are dataset_directory.h.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/dataset/trajectory.h"

namespace raven_correction {

/// Reads MATLAB files (level 5 or 7.3) with the variables of `rll/raven_2`,
/// raven_2_calibration/data:
///
///   z, r, c     n x 16: poses commanded, of the encoders, of the cameras; row-major 4 x 4
///   homogeneous
///               matrices in one base frame (m)
///   zs, rs, cs  n: their stamps (s)
///
/// Other variables are left alone. The rotation of each pose becomes the nearest proper one
/// (nearestRotation()); a matrix further than 1e-3 from it is refused.
/// @param paths  files, or directories of which every *.mat is read
/// @param frame  of the poses; the released files do not say it, their code uses 0_link
/// @return one trajectory per file, with the file's name without ".mat" as its id, in order of
/// start time
/// @throws InvalidInput  no file; not a MATLAB file; a variable is missing, of another shape or
/// type;
///         a number is not finite, a stamp goes back, or a matrix is no pose (file, variable, row)
Dataset readMatRecordings(const std::vector<std::string>& paths,
                          const std::string& frame = "0_link");

/// True where a path is a *.mat file, or a directory without dataset.yaml that holds one.
bool holdsMatRecordings(const std::string& path);

}  // namespace raven_correction
