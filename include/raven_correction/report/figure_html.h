// SPDX-License-Identifier: BSD-3-Clause
// A figure as a piece of XHTML: its panels side by side, one legend for all of them, and a caption
// that says how to read it. One panel alone is panel_svg.h, the page around it html_document.h.
#pragma once

#include <string>

#include "raven_correction/report/figure.h"

namespace raven_correction {

/// A <figure> element. @param number  counted from 1, for the caption
std::string figureHtml(const Figure& figure, int number);

}  // namespace raven_correction
