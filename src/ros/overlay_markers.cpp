// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/overlay_markers.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "overlay_painter.h"
#include "raven_correction/correction/corrector_code.h"
#include "raven_correction/error.h"

namespace raven_correction {
namespace {

using namespace overlay_painter;  // NOLINT: the pen of this file

constexpr double kDegrees = 180.0 / M_PI;
constexpr std::size_t kStatusLines = 12;  // shown at most

/// Opacity from 0.15 for the oldest point of a trail to 1 for the newest.
double freshness(std::size_t i, std::size_t n) {
  return 0.15 + 0.85 * static_cast<double>(i + 1) / static_cast<double>(n);
}

void drawTrails(const OverlayHistory& history, const OverlayStyle& style, Painter& paint) {
  const double width = style.axis_length / 20.0;
  const auto& desired = history.desired();
  Marker& line = paint.add("trail_desired", Marker::LINE_STRIP, desired.size() >= 2);
  line.scale.x = width;
  for (std::size_t i = 0; i < desired.size(); ++i)
    addPoint(line, desired[i].pose.p, faded(kDesiredColour, freshness(i, desired.size())));

  // Dashes of equal length in space, not in time: they stay dashes when the robot is slow.
  const auto& command = history.command();
  Marker& dashes = paint.add("trail_command", Marker::LINE_LIST, command.size() >= 2);
  dashes.scale.x = width;
  double travelled = 0.0;
  for (std::size_t i = 1; i < command.size(); ++i) {
    const bool drawn = std::fmod(travelled, style.axis_length / 3) < style.axis_length / 6;
    travelled += (command[i].pose.p - command[i - 1].pose.p).norm();
    if (!drawn) continue;
    const auto c = faded(kCommandColour, freshness(i, command.size()));
    addPoint(dashes, command[i - 1].pose.p, c);
    addPoint(dashes, command[i].pose.p, c);
  }
  if (dashes.points.empty()) dashes.action = Marker::DELETE;

  const auto& observed = history.observed();
  Marker& dots = paint.add("trail_observed", Marker::SPHERE_LIST, !observed.empty());
  dots.scale.x = dots.scale.y = dots.scale.z = 1.6 * width;
  Eigen::Vector3d last = Eigen::Vector3d::Constant(1e9);
  for (std::size_t i = 0; i < observed.size(); ++i) {
    if ((observed[i].pose.p - last).norm() < style.axis_length / 10) continue;
    last = observed[i].pose.p;
    addPoint(dots, last, faded(kObservedColour, freshness(i, observed.size())));
  }
}

/// Where the arrow of an error ends: at the observed position, or beyond it where errors are
/// exaggerated.
Eigen::Vector3d tipOf(const TrackingError& error, const OverlayStyle& style) {
  return error.desired.p + style.exaggeration * (error.observed.p - error.desired.p);
}

// Cividis (Nunez, Anderton, Renslow 2018), dark to bright: the colour-blind see the same order.
const std::array<std_msgs::ColorRGBA, 4> kScale{colour(70, 120, 190), colour(124, 123, 120),
                                                colour(187, 173, 108), colour(255, 234, 70)};

/// Class of an error on the scale of colours and sizes.
std::size_t classOf(double error, const OverlayStyle& style) {
  const double share = error / style.error_scale * static_cast<double>(kScale.size());
  return std::min(kScale.size() - 1, static_cast<std::size_t>(std::max(0.0, share)));
}

/// Where the tool was seen, in the colour and size of the error there, with a legend at `top`.
void drawErrorTrail(const OverlayHistory& history, const OverlayStyle& style,
                    const Eigen::Vector3d& top, Painter& paint) {
  const bool any = !history.errors().empty();
  for (std::size_t k = 0; k < kScale.size(); ++k) {
    Marker& balls = paint.add("trail_error", Marker::SPHERE_LIST, true);
    balls.color = kScale[k];
    balls.scale.x = balls.scale.y = balls.scale.z =
        style.axis_length * (0.08 + 0.06 * static_cast<double>(k));
    for (const TrackingError& error : history.errors())
      if (classOf(error.position(), style) == k)
        balls.points.push_back(pointToMsg(error.observed.p));
    if (balls.points.empty()) balls.action = Marker::DELETE;
  }
  std::vector<TextLine> legend{{any ? "error where the tool was seen" : "", kWhite}};
  const double step = 1e3 * style.error_scale / static_cast<double>(kScale.size());
  for (std::size_t k = 0; any && k < kScale.size(); ++k) {
    const double low = step * static_cast<double>(k);
    const char* const size[] = {"smallest", "small", "large", "largest"};
    legend.push_back({k + 1 < kScale.size()
                          ? format("%s balls: %g to %g mm", size[k], low, low + step)
                          : format("%s balls: above %g mm", size[k], low),
                      kScale[k]});
  }
  paint.lines("trail_error", top, legend, kScale.size() + 1, 0.9);
}

/// Two standard deviations of the predicted command each way: where it will turn out to have been
/// right.
void drawDeviation(const OverlayView& view, const OverlayStyle& style, Painter& paint) {
  const bool shown = view.command && view.sd_position && view.sd_position->maxCoeff() > 0.0;
  Marker& ball = paint.add("deviation", Marker::SPHERE, shown);
  ball.color = faded(kCommandColour, 0.25);
  const Eigen::Vector3d size = 4.0 * view.sd_position.value_or(Eigen::Vector3d::Zero());
  const Pose centre = view.command.value_or(Pose{});
  ball.pose.position = pointToMsg(centre.p);
  ball.scale.x = std::max(1e-5, size.x());
  ball.scale.y = std::max(1e-5, size.y());
  ball.scale.z = std::max(1e-5, size.z());
  paint.text("deviation", shown,
             centre.p + Eigen::Vector3d(0.5 * size.x() + 2.0 * style.axis_length, 0.0, 0.0),
             shown ? format("2 sigma: %.1f, %.1f, %.1f mm", 500.0 * size.x(), 500.0 * size.y(),
                            500.0 * size.z())
                   : "",
             kCommandColour, 0.8);
}

void drawErrors(const OverlayView& view, const OverlayHistory& history, const OverlayStyle& style,
                Painter& paint) {
  const double width = style.axis_length / 20.0;
  for (const bool corrected : {false, true}) {
    Marker& lines =
        paint.add(corrected ? "errors_corrected" : "errors_uncorrected", Marker::LINE_LIST, true);
    lines.scale.x = corrected ? 1.2 * width : 0.7 * width;
    lines.color = corrected ? kCorrectedColour : kUncorrectedColour;
    lines.color.a = corrected ? 1.0F : 0.65F;
    for (const TrackingError& error : history.errors()) {
      if (error.corrected != corrected) continue;
      const Eigen::Vector3d from = error.desired.p, to = tipOf(error, style);
      lines.points.push_back(pointToMsg(from));
      lines.points.push_back(pointToMsg(to));
      if (corrected) continue;
      const Eigen::Vector3d along = to - from;  // two strokes make a head
      const Eigen::Vector3d aside = along.unitOrthogonal() * 0.06 * along.norm();
      for (const double side : {-1.0, 1.0}) {
        lines.points.push_back(pointToMsg(to));
        lines.points.push_back(pointToMsg(to - 0.12 * along + side * aside));
      }
    }
    if (lines.points.empty()) lines.action = Marker::DELETE;
  }

  const TrackingError now = view.error.value_or(TrackingError{});
  const auto c = now.corrected ? kCorrectedColour : kUncorrectedColour;
  paint.arrow("error", view.error.has_value(), now.desired.p, tipOf(now, style),
              style.axis_length / 12.0, c);
  const Eigen::Vector3d above(0.0, 0.0, 2.2 * style.axis_length);
  std::string kind = now.corrected ? "corrected error" : "uncorrected error";
  if (style.exaggeration != 1.0) kind += format(", drawn %g times as long", style.exaggeration);
  const bool shown = view.error.has_value();
  paint.lines("error", now.observed.p + above,
              {{shown ? kind : "", c}, {shown ? errorText(now.position(), now.angle()) : "", c}}, 2,
              1.3);
}

void drawWorkspace(const std::optional<OverlayBox>& box, const OverlayStyle& style,
                   Painter& paint) {
  Marker& edges = paint.add("workspace", Marker::LINE_LIST, box.has_value());
  edges.scale.x = style.axis_length / 30.0;
  edges.color = faded(kGrey, 0.7);
  const OverlayBox b = box.value_or(OverlayBox{});
  const double dash = style.axis_length / 4;
  for (int axis = 0; axis < 3; ++axis)
    for (int corner = 0; corner < 4; ++corner) {
      Eigen::Vector3d from = b.min;
      const int second = (axis + 1) % 3, third = (axis + 2) % 3;
      if (corner & 1) from(second) = b.max(second);
      if (corner & 2) from(third) = b.max(third);
      const double length = b.max(axis) - b.min(axis);
      const int count = std::min(200, 1 + static_cast<int>(length / dash)) | 1;  // ends in a dash
      for (int i = 0; i < count; i += 2)
        for (const int end : {i, i + 1}) {
          Eigen::Vector3d p = from;
          p(axis) += length * end / count;
          edges.points.push_back(pointToMsg(p));
        }
    }
  const Eigen::Vector3d corner(b.min.x(), b.min.y(), b.min.z() - 1.5 * style.text_height);
  paint.text("workspace", box.has_value(), corner, "trained workspace", kGrey, 0.9);
}

}  // namespace

MarkerArray makeOverlay(const OverlayView& view, const OverlayHistory& history,
                        const OverlayStyle& style) {
  MarkerArray array;
  Painter paint(style, array);
  drawWorkspace(view.workspace, style, paint);
  drawTrails(history, style, paint);
  drawErrors(view, history, style, paint);
  drawDeviation(view, style, paint);
  paint.axes("desired", view.desired, Marker::SPHERE, kDesiredColour);
  paint.axes("command", view.command, Marker::CUBE, kCommandColour);
  paint.axes("observed", view.observed, Marker::CYLINDER, kObservedColour);

  // One legend below the tool, because labels at poses that fall together cannot be read.
  const Pose anchor = view.desired.value_or(view.observed.value_or(view.command.value_or(Pose{})));
  const double below = anchor.p.z() - 1.5 * style.axis_length;
  const Eigen::Vector3d legend(anchor.p.x(), anchor.p.y(), below);
  paint.lines("labels", legend,
              {{view.desired ? "desired (ball, line)" : "", kDesiredColour},
               {view.command ? "command (cube, dashes)" : "", kCommandColour},
               {view.observed ? "observed (disc, dots)" : "", kObservedColour}},
              3, 1.0);

  Eigen::Vector3d top = anchor.p + Eigen::Vector3d(0.0, 0.0, 6.0 * style.axis_length);
  if (view.workspace) {
    top = (view.workspace->min + view.workspace->max) / 2;
    top.z() = view.workspace->max.z() + style.axis_length;
  }
  const double beside = 4.0 * style.axis_length;  // to the left of the scene
  Eigen::Vector3d aside = anchor.p - beside * Eigen::Vector3d::UnitX();
  if (view.workspace) aside = {view.workspace->min.x() - beside, top.y(), view.workspace->max.z()};
  drawErrorTrail(history, style, aside, paint);

  std::vector<TextLine> status;
  for (const std::string& line : view.status) status.push_back({line, kWhite});
  const double height = kLineSpacing * style.text_height * 1.2;
  top.z() += height * static_cast<double>(status.size());
  paint.lines("status", top, status, kStatusLines, 1.2);
  return array;
}

std::string correctionCodeName(std::uint8_t code) {
  std::string name = correctorCodeName(static_cast<CorrectorCode>(code));
  std::replace(name.begin(), name.end(), '_', ' ');
  if (isRefused(static_cast<CorrectorCode>(code)))  // what is not sent has to be seen
    std::transform(name.begin(), name.begin() + 7, name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return name;
}

bool isCorrectedCode(std::uint8_t code) {
  return code <= static_cast<std::uint8_t>(CorrectorCode::kRigidOnly);
}

std::string errorText(double position, double angle) {
  return format("%.2f mm, %.2f deg", 1e3 * position, kDegrees * angle);
}

}  // namespace raven_correction
