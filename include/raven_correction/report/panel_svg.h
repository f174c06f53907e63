// SPDX-License-Identifier: BSD-3-Clause
// One panel of a figure drawn as SVG: frame, ticks, units, marks. A picture of its own, dark on
// white, without references to anything outside. Panels with a legend and a caption are
// figure_html.h.
#pragma once

#include <string>

#include "raven_correction/report/figure.h"

namespace raven_correction {

/// An <svg> element of panel.width x panel.height that scales with its surroundings, with <title>
/// and <desc>.
std::string panelSvg(const Panel& panel);

/// How a layer looks in a legend: an <svg> element of 24 x 12.
std::string swatchSvg(const Layer& layer);

}  // namespace raven_correction
