// SPDX-License-Identifier: BSD-3-Clause
// Pen and colours of all markers: the palette that the colour-blind can tell apart, text, arrows
// and axes. What is drawn with it is overlay_markers.cpp and training_markers.cpp.
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "raven_correction/geometry/pose.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/overlay_markers.h"

namespace raven_correction {

namespace overlay_painter {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

inline std_msgs::ColorRGBA colour(int r, int g, int b, double alpha = 1.0) {
  std_msgs::ColorRGBA c;
  c.r = static_cast<float>(r) / 255.0F;
  c.g = static_cast<float>(g) / 255.0F;
  c.b = static_cast<float>(b) / 255.0F;
  c.a = static_cast<float>(alpha);
  return c;
}

// Okabe and Ito, "Color Universal Design", 2008; grey for what is not a pose.
inline const std_msgs::ColorRGBA kDesiredColour = colour(86, 180, 233);    // sky blue
inline const std_msgs::ColorRGBA kCommandColour = colour(230, 159, 0);     // orange
inline const std_msgs::ColorRGBA kObservedColour = colour(0, 158, 115);    // bluish green
inline const std_msgs::ColorRGBA kUncorrectedColour = colour(213, 94, 0);  // vermillion
inline const std_msgs::ColorRGBA kCorrectedColour = colour(240, 228, 66);  // yellow
inline const std_msgs::ColorRGBA kGrey = colour(170, 170, 170);
inline const std_msgs::ColorRGBA kWhite = colour(245, 245, 245);

inline std_msgs::ColorRGBA faded(std_msgs::ColorRGBA c, double share) {
  c.a = static_cast<float>(share);
  return c;
}

struct TextLine {
  std::string words;
  std_msgs::ColorRGBA colour;
};

constexpr double kLineSpacing = 1.5;  // in capital letters; rviz itself spaces lines wider

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

  /// One that is ready.
  void append(const Marker& marker) { array_.markers.push_back(marker); }

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

inline void addPoint(Marker& marker, const Eigen::Vector3d& p, const std_msgs::ColorRGBA& c) {
  marker.points.push_back(pointToMsg(p));
  marker.colors.push_back(c);
}

}  // namespace overlay_painter
}  // namespace raven_correction
