// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/figure_html.h"

#include <set>

#include "raven_correction/error.h"
#include "raven_correction/report/panel_svg.h"
#include "raven_correction/report/xml_text.h"

namespace raven_correction {
namespace {

std::string legendHtml(const Figure& figure) {
  std::set<std::string> known;
  std::string entries;
  for (const Panel& panel : figure.panels)
    for (const Layer& layer : panel.layers) {
      const auto label = std::visit(
          [](const auto& l) {
            // A heat map's label stands on its colour bar.
            return std::is_same_v<std::decay_t<decltype(l)>, HeatMap> ? std::string() : l.label;
          },
          layer);
      if (label.empty() || !known.insert(label).second) continue;
      entries += "<li>" + swatchSvg(layer) + " " + xmlText(label) + "</li>";
    }
  return entries.empty() ? std::string() : "<ul class=\"legend\">" + entries + "</ul>\n";
}

}  // namespace

std::string figureHtml(const Figure& figure, int number) {
  std::string html = "<figure>\n";
  html += legendHtml(figure);
  html += format("<div class=\"panels columns-%d\">\n", figure.columns);
  for (const Panel& panel : figure.panels) html += panelSvg(panel) + "\n";
  html += "</div>\n";
  html += format("<figcaption><strong>Figure %d. ", number) + xmlText(figure.title) +
          ".</strong> " + xmlText(figure.how_to_read);
  if (!figure.good.empty()) html += " <em>Good:</em> " + xmlText(figure.good);
  return html + "</figcaption>\n</figure>\n";
}

}  // namespace raven_correction
