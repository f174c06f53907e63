// SPDX-License-Identifier: BSD-3-Clause
// From where to where the axes of a panel go, and how panels that are to be compared get the same
// limits. Round ticks between them are axis_scale.h.
#pragma once

#include "raven_correction/report/axis_scale.h"
#include "raven_correction/report/figure.h"

namespace raven_correction {

struct PanelLimits {
  Range x, y;
  bool empty = false;  ///< nothing finite to show: the limits are 0 to 1
};

/// What the axes say where they say it, else what the layers need with a small margin; bars and
/// counts start at zero. Categories have half a place on either side.
PanelLimits limitsOf(const Panel& panel);

/// Gives all panels the limits that hold the data of every one of them, so that before and after
/// can be compared by eye. Limits that an axis sets itself count as its data: the shared ones
/// include them. Axes of categories, and panels with nothing to show, are left as they are.
void shareLimits(std::vector<Panel*> panels, bool share_x, bool share_y);

/// The limits of the colours of all heat maps in the panels become the same, too.
void shareColours(std::vector<Panel*> panels);

/// Sets the limits of one axis so that `share` of the values lie between them, symmetric tails left
/// out: single wild values would squeeze the rest into a line.
/// @return how many of the values lie outside
std::size_t limitTo(Axis& axis, const std::vector<double>& values, double share);

}  // namespace raven_correction
