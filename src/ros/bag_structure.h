// SPDX-License-Identifier: BSD-3-Clause
// Lengths and places in a bag that rosbag believes without looking.
#pragma once

#include <string>

#include "raven_correction/ros/bag_file.h"

namespace raven_correction {

/// Walks through a bag of version 2.0 (http://wiki.ros.org/Bags/Format/2.0), also within its
/// compressed chunks, so that rosbag, which follows the lengths and places in it, reads nothing
/// beyond its memory if some of them are damaged: every record and field ends within what it is in,
/// no field comes twice, the index and the summary name places where there is such a record, and
/// connections have the fields that are asked for. Messages themselves are not looked into. A bag
/// without an index passes: rosbag says so.
/// @param parts  of the bag that are going to be read
/// @throws rosbag::BagException  with the byte of the file and what is wrong there
void checkBagStructure(const std::string& file, BagParts parts);

}  // namespace raven_correction
