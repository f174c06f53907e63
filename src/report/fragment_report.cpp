// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/fragment_report.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/error.h"
#include "report_json.h"

namespace raven_correction {
namespace {

constexpr double kLimit = 1e-3;        // [m]
constexpr double kInside = 7.815;      // 95 % of chi-square with three degrees of freedom
constexpr double kElongated = 1.3;     // length / width of what has a direction
constexpr double kYawLimit = 10.0;     // [deg]
constexpr double kMilliseconds = 1e3;  // per second

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  const double last = static_cast<double>(values.size() - 1);
  return values[static_cast<std::size_t>(std::lround(share * last))];
}

/// What both texts say.
struct Summary {
  std::vector<double> errors;  // [m]
  double normalised2 = 0.0;
  double inside = 0.0;
  int hidden = 0;
  int hidden_within = 0;
  int elongated = 0;
  double yaw_within = 0.0;
  double yaw_normalised = 0.0;
};

Summary summarise(const FragmentScore& score) {
  Summary s;
  double yaw_square = 0.0;
  for (const FragmentMatch& match : score.matches) {
    s.errors.push_back(match.distance);
    s.normalised2 += match.mahalanobis2;
    s.inside += match.mahalanobis2 < kInside;
    if (match.partly_hidden) {
      ++s.hidden;
      s.hidden_within += match.distance <= kLimit;
    }
    if (match.slenderness < kElongated) continue;
    ++s.elongated;
    s.yaw_within += std::abs(match.yaw_error) * kDegree < kYawLimit;
    yaw_square += std::pow(match.yaw_error / match.yaw_deviation, 2.0);
  }
  const double n = std::max<double>(1.0, static_cast<double>(score.matches.size()));
  s.normalised2 /= n;
  s.inside /= n;
  if (s.elongated > 0) {
    s.yaw_within /= s.elongated;
    s.yaw_normalised = std::sqrt(yaw_square / s.elongated);
  }
  return s;
}

}  // namespace

std::string fragmentText(const FragmentScore& score) {
  const Summary s = summarise(score);
  std::string text = format(
      "%d rendered scenes with %d fragments, %d of them at least half visible in both images\n",
      score.scenes, score.fragments, score.half_visible);
  text += format("  found            %d of %d = %.2f %%\n", score.half_visible_found,
                 score.half_visible, kPercent * score.foundShare());
  text += format("  partly covered   %d of %d found\n", score.overlapped_found, score.overlapped);
  text += format("  within 1 mm      %.2f %%\n", kPercent * score.withinShare(kLimit));
  text += format("  fitted outline   %d of %d within 1 mm\n", s.hidden_within, s.hidden);
  text += format("  false            %d of %d detections; %d more on a fragment, but too far off\n",
                 score.false_detections, score.detections, score.displaced);
  text += format("  error            median %.2f, 95 %% %.2f, largest %.2f mm\n",
                 kMillimetre * quantile(s.errors, 0.5), kMillimetre * quantile(s.errors, 0.95),
                 kMillimetre * quantile(s.errors, 1.0));
  text += format(
      "  covariance       squared error / covariance %.2f (3 is right), 95 %% ellipsoid "
      "holds %.1f %%\n",
      s.normalised2, kPercent * s.inside);
  text += format(
      "  yaw              of %d elongated ones %.1f %% within %g deg, rms error / "
      "deviation %.2f\n",
      s.elongated, kPercent * s.yaw_within, kYawLimit, s.yaw_normalised);
  text += format("  time             median %.0f, 95 %% %.0f ms per pair of images\n",
                 kMilliseconds * quantile(score.detection_time, 0.5),
                 kMilliseconds * quantile(score.detection_time, 0.95));
  return text;
}

std::string fragmentJson(const FragmentScore& score) {
  const Summary s = summarise(score);
  Json json;
  json["scenes"] = score.scenes;
  json["fragments"] = score.fragments;
  json["half_visible"] = score.half_visible;
  json["half_visible_found"] = score.half_visible_found;
  json["overlapped"] = score.overlapped;
  json["overlapped_found"] = score.overlapped_found;
  json["detections"] = score.detections;
  json["false_detections"] = score.false_detections;
  json["displaced_detections"] = score.displaced;
  json["found_percent"] = kPercent * score.foundShare();
  json["within_1mm_percent"] = kPercent * score.withinShare(kLimit);
  json["error_mm"] = {{"median", kMillimetre * quantile(s.errors, 0.5)},
                      {"p95", kMillimetre * quantile(s.errors, 0.95)},
                      {"largest", kMillimetre * quantile(s.errors, 1.0)}};
  json["normalised_error2"] = s.normalised2;
  json["inside_95_percent"] = kPercent * s.inside;
  json["yaw"] = {{"fragments", s.elongated},
                 {"within_10deg_percent", kPercent * s.yaw_within},
                 {"rms_normalised", s.yaw_normalised}};
  json["detection_ms"] = {{"median", kMilliseconds * quantile(score.detection_time, 0.5)},
                          {"p95", kMilliseconds * quantile(score.detection_time, 0.95)}};
  return json.dump(2) + "\n";
}

}  // namespace raven_correction
