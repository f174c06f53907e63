// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "raven_correction/report/figure_html.h"
#include "raven_correction/report/figure_limits.h"
#include "raven_correction/report/panel_svg.h"
#include "raven_correction/report/xml_text.h"
#include "report/page.h"

namespace raven_correction {
namespace {

const double kNan = std::nan("");
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Every kind of layer, with numbers that are none among them.
Panel everything() {
  Panel panel;
  panel.title = "a < b & \"c\"";
  panel.x = Axis("speed", "mm/s");
  panel.y = Axis("error", "mm");
  Points points;
  points.label = "points";
  points.x = {0.0, 1.0, kNan, 3.0};
  points.y = {1.0, kInfinity, 2.0, 3.0};
  Line line;
  line.label = "line";
  line.x = {0.0, 1.0, 2.0, 3.0, 4.0};
  line.y = {0.0, 1.0, kNan, 3.0, 4.0};
  line.markers = true;
  Band band;
  band.label = "band";
  band.x = {0.0, 1.0, 2.0, 3.0, 4.0};
  band.lower = {0.0, 0.0, kNan, 0.0, 0.0};
  band.upper = {1.0, 1.0, 1.0, 1.0, 1.0};
  Bars bars;
  bars.label = "bars";
  bars.position = {0.0, 1.0};
  bars.value = {1.0, kNan};
  bars.lower = {0.5, kNan};
  bars.upper = {1.5, kNan};
  bars.decimals = 1;
  Boxes boxes;
  boxes.label = "boxes";
  boxes.position = {2.0, 3.0};
  boxes.quantiles = {quantilesOf({1.0, 2.0, kNan, 3.0}), {}};
  Histogram histogram = histogramOf({0.5, 1.5, kNan, 9.0}, 0.0, 2.0, 2);
  histogram.label = "histogram";
  Rule rule;
  rule.label = "rule";
  rule.value = 2.5;
  panel.layers = {points, line, band, bars, boxes, histogram, rule};
  return panel;
}

TEST(XmlText, HoldsAnything) {
  EXPECT_EQ(xmlText("a<b>&\"'c"), "a&lt;b&gt;&amp;&quot;&#39;c");
  EXPECT_EQ(xmlText("\xC2\xB5m"), "\xC2\xB5m");
  EXPECT_EQ(xmlText(std::string("a\0b\x01", 4)),
            "a\xEF\xBF\xBD"
            "b\xEF\xBF\xBD");
  EXPECT_EQ(xmlText("\xFF\xC0\xAF"), "\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD");
  EXPECT_EQ(xmlText("\xE2\x82"), "\xEF\xBF\xBD\xEF\xBF\xBD");  // cut off
  // Any bytes at all make a page that a parser reads.
  std::mt19937 engine(3);
  std::string bytes;
  for (int i = 0; i < 4000; ++i) bytes += static_cast<char>(engine() & 0xFFU);
  EXPECT_EQ(problemsOf("<p title=\"" + xmlText(bytes) + "\">" + xmlText(bytes) + "</p>"), "");
}

TEST(NiceTicks, AreRoundAndInside) {
  const auto labels = [](double lower, double upper, int n) {
    std::string text;
    for (const Tick& tick : niceTicks({lower, upper}, n)) text += tick.label + " ";
    return text;
  };
  EXPECT_EQ(labels(0.0, 10.0, 5), "0 2 4 6 8 10 ");
  EXPECT_EQ(labels(-3.4, 3.4, 2),
            "\xE2\x88\x92"
            "2 0 2 ");
  EXPECT_EQ(labels(0.0, 0.05, 5), "0.00 0.01 0.02 0.03 0.04 0.05 ");
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> exponent(-9.0, 9.0), mantissa(-5.0, 5.0);
  for (int i = 0; i < 2000; ++i) {
    const double a = mantissa(engine) * std::pow(10.0, exponent(engine));
    const double width = std::pow(10.0, exponent(engine));
    if (!(width > 1e-7 * std::abs(a))) continue;
    const std::vector<Tick> ticks = niceTicks({a, a + width}, 6);
    EXPECT_GE(ticks.size(), 2u) << a << " " << width;
    EXPECT_LE(ticks.size(), 13u) << a << " " << width;
    for (const Tick& tick : ticks) {
      EXPECT_GE(tick.at, a - 1e-6 * width);
      EXPECT_LE(tick.at, a + (1.0 + 1e-6) * width);
    }
  }
}

TEST(LogarithmicTicks, StandAtOneTwoFive) {
  std::string text;
  for (const Tick& tick : logarithmicTicks({0.15, 30.0}, 8)) text += tick.label + " ";
  EXPECT_EQ(text, "0.2 0.5 1 2 5 10 20 ");
}

TEST(NumberText, HasTrueMinusAndNoNegativeZero) {
  EXPECT_EQ(numberText(-1.26, 1),
            "\xE2\x88\x92"
            "1.3");
  EXPECT_EQ(numberText(-0.01, 1), "0.0");
  EXPECT_EQ(numberText(kNan, 1), "n/a");
  EXPECT_EQ(numberText(kInfinity, 1), "n/a");
}

TEST(Panel, IsWellFormedWhateverTheNumbers) {
  EXPECT_EQ(problemsOf(panelSvg(everything())), "");
  Panel empty = everything();
  empty.layers.clear();
  EXPECT_EQ(problemsOf(panelSvg(empty)), "");
  EXPECT_TRUE(contains(panelSvg(empty), "no data"));
  Panel logarithmic = everything();
  logarithmic.x.logarithmic = logarithmic.y.logarithmic = true;  // with zeros in it
  EXPECT_EQ(problemsOf(panelSvg(logarithmic)), "");
  Panel constant;
  Points one;
  one.x = one.y = {7.0};
  constant.layers = {one};
  EXPECT_EQ(problemsOf(panelSvg(constant)), "");
  HeatMap heat;
  heat.x_edges = {0.0, 1.0, 2.0};
  heat.y_edges = {0.0, 1.0};
  heat.values = Eigen::MatrixXd::Constant(1, 2, kNan);
  heat.label = "mm";
  constant.layers = {heat};
  EXPECT_EQ(problemsOf(panelSvg(constant)), "");
  heat.values(0, 1) = 3.0;
  constant.layers = {heat};
  EXPECT_EQ(problemsOf(panelSvg(constant)), "");
  EXPECT_TRUE(contains(panelSvg(constant), ">3.0</text>"));
}

// Zero is infinitely far away on a logarithmic axis: what stands there is left out, and not drawn
// at the edge as if it were a value.
TEST(Panel, LeavesOutWhatALogarithmicAxisDoesNotHave) {
  Panel panel;
  panel.x = panel.y = Axis("size", "mm");
  panel.x.logarithmic = panel.y.logarithmic = true;
  panel.x.lower = panel.y.lower = 0.1;
  panel.x.upper = panel.y.upper = 10.0;
  Line line;
  line.x = line.y = {0.2, 1.0, 5.0};
  panel.layers = {line};
  const std::string without = panelSvg(panel);
  for (const bool vertical : {true, false}) {
    Rule rule;
    rule.vertical = vertical;
    for (const double nowhere : {0.0, -1.0, kNan}) {
      rule.value = nowhere;
      panel.layers = {line, rule};
      EXPECT_EQ(panelSvg(panel), without) << nowhere;
    }
    rule.value = 2.0;
    panel.layers = {line, rule};
    EXPECT_NE(panelSvg(panel), without);
  }
  Band band;
  band.x = {0.2, 1.0, 5.0};
  band.lower = {0.0, 0.0, 0.0};
  band.upper = {1.0, 1.0, 1.0};
  Boxes boxes;
  boxes.position = {1.0};
  boxes.quantiles = {{0.0, 0.0, 0.0, 0.0, 0.0}};
  panel.layers = {line, band, boxes};
  EXPECT_EQ(panelSvg(panel), without);
}

TEST(Panel, HasUnitsOnItsAxesAndNeedsNoColour) {
  const std::string svg = panelSvg(everything());
  EXPECT_TRUE(contains(svg, "speed [mm/s]"));
  EXPECT_TRUE(contains(svg, "error [mm]"));
  EXPECT_TRUE(contains(svg, "a &lt; b &amp; &quot;c&quot;"));
  EXPECT_TRUE(contains(svg, ">n/a</text>"));  // the bar without a number
}

TEST(Figure, SharesOneLegend) {
  Figure figure;
  figure.panels = {everything(), everything()};
  figure.how_to_read = "read <it>";
  const std::string html = figureHtml(figure, 3);
  EXPECT_EQ(problemsOf("<div>" + html + "</div>"), "");
  EXPECT_EQ(count(html, "<li>"), 7u);
  EXPECT_TRUE(contains(html, "Figure 3."));
  EXPECT_TRUE(contains(html, "read &lt;it&gt;"));
}

TEST(ShareLimits, MakesBeforeAndAfterComparable) {
  Panel before, after;
  Line line;
  line.x = {0.0, 1.0};
  line.y = {-5.0, 5.0};
  before.layers = {line};
  line.y = {-1.0, 1.0};
  after.layers = {line};
  shareLimits({&before, &after}, true, true);
  const PanelLimits a = limitsOf(before), b = limitsOf(after);
  EXPECT_EQ(a.y.lower, b.y.lower);
  EXPECT_EQ(a.y.upper, b.y.upper);
  EXPECT_LT(a.y.lower, -5.0);
  EXPECT_EQ(labelsAtEnd(panelSvg(before)), labelsAtEnd(panelSvg(after)));
  // Limits of its own are data like any other: the shared ones hold them.
  before.y = after.y = Axis("error", "mm");
  before.y.upper = 9.0;
  shareLimits({&before, &after}, false, true);
  EXPECT_EQ(limitsOf(after).y.upper, 9.0);
  EXPECT_LT(limitsOf(before).y.lower, -5.0);
  EXPECT_EQ(limitsOf(before).y.lower, limitsOf(after).y.lower);
}

TEST(Panel, IsDescribedByItsAxesWhereNothingElseIsSaid) {
  Panel panel = everything();
  EXPECT_TRUE(contains(panelSvg(panel), "<desc>error [mm] against speed [mm/s]</desc>"));
  panel.description = "how fast, how wrong";
  EXPECT_TRUE(contains(panelSvg(panel), "<desc>how fast, how wrong</desc>"));
}

TEST(LimitTo, KeepsWildValuesFromSqueezingTheRest) {
  std::vector<double> values;
  for (int i = 0; i < 1000; ++i) values.push_back(0.001 * i);
  values.push_back(1e6);
  values.push_back(kNan);
  Axis axis;
  EXPECT_GE(limitTo(axis, values, 0.98), 1u);
  EXPECT_LT(axis.upper, 1.1);
  Axis none;
  EXPECT_EQ(limitTo(none, {kNan}, 0.98), 0u);
  EXPECT_TRUE(std::isnan(none.lower));
}

TEST(Summaries, LeaveOutWhatIsNoNumber) {
  const Boxes::Quantiles q = quantilesOf({0.0, 1.0, 2.0, kNan, 3.0, 4.0});
  EXPECT_DOUBLE_EQ(q.p50, 2.0);
  EXPECT_DOUBLE_EQ(q.p25, 1.0);
  EXPECT_TRUE(std::isnan(quantilesOf({kNan}).p50));
  const Histogram histogram = histogramOf({-5.0, 0.1, 0.9, 1.1, 7.0, kNan}, 0.0, 2.0, 2);
  EXPECT_EQ(histogram.counts, (std::vector<double>{3.0, 2.0}));
  const Line line = cumulativeOf({3.0, kNan, 1.0, 2.0, 4.0});
  EXPECT_DOUBLE_EQ(line.x.front(), 1.0);
  EXPECT_DOUBLE_EQ(line.x.back(), 4.0);
  EXPECT_DOUBLE_EQ(line.y.back(), 100.0);
  std::vector<double> x, y;
  for (int i = 0; i < 100; ++i) {
    x.push_back(i);
    y.push_back(i % 10 == 0 ? kNan : 2.0 * i);
  }
  const Trend trend = trendOf(x, y, 5);
  ASSERT_EQ(trend.median.x.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_DOUBLE_EQ(trend.median.y[i], 2.0 * trend.median.x[i]);
    EXPECT_LT(trend.quartiles.lower[i], trend.median.y[i]);
  }
  EXPECT_TRUE(trendOf({1.0, 2.0}, {1.0, 2.0}, 4).median.x.empty());
}

// Thousands of points cost about a dozen bytes each.
TEST(Points, AreSmallFiles) {
  Panel panel;
  Points points;
  for (int i = 0; i < 10000; ++i) {
    points.x.push_back(std::sin(0.1 * i));
    points.y.push_back(std::cos(0.37 * i));
  }
  panel.layers = {points};
  EXPECT_LT(panelSvg(panel).size(), 160000u);
}

}  // namespace
}  // namespace raven_correction
