// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/overlay_markers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "raven_correction/CorrectionStatus.h"
#include "raven_correction/correction/corrector_code.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/conversions.h"

namespace raven_correction {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr double kDegrees = 180.0 / M_PI;

std_msgs::ColorRGBA colour(int r, int g, int b, double alpha = 1.0) {
  std_msgs::ColorRGBA c;
  c.r = static_cast<float>(r) / 255.0F;
  c.g = static_cast<float>(g) / 255.0F;
  c.b = static_cast<float>(b) / 255.0F;
  c.a = static_cast<float>(alpha);
  return c;
}

// Okabe and Ito, "Color Universal Design", 2008; grey for what is not a pose.
const std_msgs::ColorRGBA kDesiredColour = colour(86, 180, 233);    // sky blue
const std_msgs::ColorRGBA kCommandColour = colour(230, 159, 0);     // orange
const std_msgs::ColorRGBA kObservedColour = colour(0, 158, 115);    // bluish green
const std_msgs::ColorRGBA kUncorrectedColour = colour(213, 94, 0);  // vermillion
const std_msgs::ColorRGBA kCorrectedColour = colour(240, 228, 66);  // yellow
const std_msgs::ColorRGBA kGrey = colour(170, 170, 170);
const std_msgs::ColorRGBA kWhite = colour(245, 245, 245);

std_msgs::ColorRGBA faded(std_msgs::ColorRGBA c, double share) {
  c.a = static_cast<float>(share);
  return c;
}

struct TextLine {
  std::string words;
  std_msgs::ColorRGBA colour;
};

constexpr double kLineSpacing = 1.5;      // in capital letters; rviz itself spaces lines wider
constexpr std::size_t kStatusLines = 10;  // shown at most

class Painter {
 public:
  Painter(const OverlayStyle& style, MarkerArray& array) : style_(style), array_(array) {}

  /// A marker to fill in, or one that deletes its predecessor; ids count up in each namespace.
  Marker& add(const std::string& ns, int type, bool shown) {
    int id = 0;
    for (const Marker& other : array_.markers) id += other.ns == ns ? 1 : 0;
    array_.markers.emplace_back();
    Marker& marker = array_.markers.back();
    marker.header.frame_id = style_.frame;  // stamp 0: draw with the latest transform
    marker.ns = ns;
    marker.id = id;
    marker.type = type;
    marker.action = shown ? Marker::ADD : Marker::DELETE;
    marker.pose.orientation.w = 1.0;
    marker.lifetime = ros::Duration(style_.lifetime);
    return marker;
  }

  void text(const std::string& ns, bool shown, const Eigen::Vector3d& p, const std::string& words,
            const std_msgs::ColorRGBA& c, double scale = 1.0) {
    Marker& marker = add(ns, Marker::TEXT_VIEW_FACING, shown && !words.empty());
    marker.pose.position = pointToMsg(p);
    marker.text = words;
    marker.color = c;
    marker.scale.z = style_.text_height * scale;
  }

  /// One marker per line, from the top down, always `count` of them.
  void lines(const std::string& ns, const Eigen::Vector3d& top, const std::vector<TextLine>& lines,
             std::size_t count, double scale) {
    const double step = kLineSpacing * style_.text_height * scale;
    for (std::size_t i = 0; i < count; ++i) {
      const TextLine line = i < lines.size() ? lines[i] : TextLine{"", kWhite};
      text(ns, !line.words.empty(), top - Eigen::Vector3d::UnitZ() * step * static_cast<double>(i),
           line.words, line.colour, scale);
    }
  }

  void arrow(const std::string& ns, bool shown, const Eigen::Vector3d& from,
             const Eigen::Vector3d& to, double diameter, const std_msgs::ColorRGBA& c) {
    const double length = (to - from).norm();
    Marker& marker = add(ns, Marker::ARROW, shown && length > 1e-6);
    marker.points = {pointToMsg(from), pointToMsg(to)};
    marker.color = c;
    marker.scale.x = diameter;                              // of the shaft
    marker.scale.y = 2.5 * diameter;                        // of the head
    marker.scale.z = std::min(4.0 * diameter, length / 2);  // length of the head
  }

  void axes(const std::string& ns, const std::optional<Pose>& pose, int shape,
            const std_msgs::ColorRGBA& c) {
    const Pose X = pose.value_or(Pose{});
    // The observed pose is slim and long, so that it stays visible when it meets the desired one.
    const bool slim = shape == Marker::CYLINDER;
    const double L = style_.axis_length * (slim ? 1.35 : 1.0);
    const std::array<double, 3> lengths{L, 0.75 * L, 0.5 * L};
    for (int axis = 0; axis < 3; ++axis)
      arrow(ns, pose.has_value(), X.p,
            X * Eigen::Vector3d(Eigen::Vector3d::Unit(axis) *
                                lengths[static_cast<std::size_t>(axis)]),
            (slim ? 0.045 : 0.08) * L, c);
    Marker& origin = add(ns, shape, pose.has_value());
    origin.pose = poseToMsg(X);
    origin.color = c;
    origin.scale.x = origin.scale.y = origin.scale.z = 0.25 * L;
    if (slim) {  // a disc
      origin.scale.x = origin.scale.y = 0.5 * L;
      origin.scale.z = 0.04 * L;
    }
  }

 private:
  const OverlayStyle& style_;
  MarkerArray& array_;
};

/// Opacity from 0.15 for the oldest point of a trail to 1 for the newest.
double freshness(std::size_t i, std::size_t n) {
  return 0.15 + 0.85 * static_cast<double>(i + 1) / static_cast<double>(n);
}

void addPoint(Marker& marker, const Eigen::Vector3d& p, const std_msgs::ColorRGBA& c) {
  marker.points.push_back(pointToMsg(p));
  marker.colors.push_back(c);
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
      const Eigen::Vector3d from = error.desired.p, to = error.observed.p;
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
  paint.arrow("error", view.error.has_value(), now.desired.p, now.observed.p,
              style.axis_length / 12.0, c);
  const Eigen::Vector3d above(0.0, 0.0, 2.2 * style.axis_length);
  const std::string kind = now.corrected ? "corrected error" : "uncorrected error";
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
  return name;
}

bool isCorrectedCode(std::uint8_t code) { return code <= CorrectionStatus::RIGID_ONLY; }

std::string errorText(double position, double angle) {
  return format("%.2f mm, %.2f deg", 1e3 * position, kDegrees * angle);
}

}  // namespace raven_correction
