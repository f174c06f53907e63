// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/training_markers.h"

#include "overlay_painter.h"
#include "raven_correction/error.h"
#include "raven_correction/geometry/convex_hull.h"

namespace raven_correction {
namespace {

using namespace overlay_painter;  // NOLINT: the pen of this file

constexpr int kGrid[3] = {5, 5, 3};   // points of the error field along x, y, z
constexpr double kFullShare = 0.999;  // of H: less is faded [-]

std::vector<Eigen::Vector3d> pointsFromMsg(const std::vector<geometry_msgs::Point>& msgs) {
  std::vector<Eigen::Vector3d> points;
  for (const geometry_msgs::Point& p : msgs) points.emplace_back(p.x, p.y, p.z);
  return points;
}

void drawKept(const TrainingSamples& samples, const OverlayStyle& style, Painter& paint) {
  Marker& balls = paint.add("samples_kept", Marker::SPHERE_LIST, !samples.kept.empty());
  balls.points = samples.kept;
  balls.color = faded(kObservedColour, 0.6);
  balls.scale.x = balls.scale.y = balls.scale.z = style.axis_length / 25.0;
}

void drawRejected(const TrainingSamples& samples, const OverlayStyle& style, Painter& paint) {
  for (std::size_t reason = 0; reason < samples.reason_names.size(); ++reason) {
    const std::string ns = "rejected_" + samples.reason_names[reason];
    Marker& cubes = paint.add(ns, Marker::CUBE_LIST, true);
    cubes.color = kUncorrectedColour;
    cubes.scale.x = cubes.scale.y = cubes.scale.z = style.axis_length / 18.0;
    Eigen::Vector3d highest = Eigen::Vector3d::Constant(-1e9);
    for (std::size_t i = 0; i < samples.rejected.size() && i < samples.reasons.size(); ++i) {
      if (samples.reasons[i] != reason) continue;
      cubes.points.push_back(samples.rejected[i]);
      if (samples.rejected[i].z > highest.z())
        highest = {samples.rejected[i].x, samples.rejected[i].y, samples.rejected[i].z};
    }
    const bool any = !cubes.points.empty();
    if (!any) cubes.action = Marker::DELETE;
    const unsigned count =
        reason < samples.reason_counts.size() ? samples.reason_counts[reason] : 0;
    paint.text(ns, any, highest + Eigen::Vector3d(0.0, 0.0, 1.2 * style.text_height),
               any ? format("rejected: %s, %u", samples.reason_names[reason].c_str(), count) : "",
               kUncorrectedColour, 0.8);
  }
}

void drawHull(const TrainingSamples& samples, const OverlayStyle& style, Painter& paint) {
  const std::vector<Eigen::Vector3d> points = pointsFromMsg(samples.kept);
  const std::vector<Triangle> triangles = convexHull(points);
  Marker& faces = paint.add("trained_hull", Marker::TRIANGLE_LIST, !triangles.empty());
  faces.color = faded(kObservedColour, 0.10);
  faces.scale.x = faces.scale.y = faces.scale.z = 1.0;
  Marker edges = faces;
  edges.type = Marker::LINE_LIST;
  edges.id = faces.id + 1;
  edges.color = faded(kObservedColour, 0.35);
  edges.scale.x = style.axis_length / 60.0;
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      faces.points.push_back(pointToMsg(points[t[k]]));
      edges.points.push_back(pointToMsg(points[t[k]]));
      edges.points.push_back(pointToMsg(points[t[(k + 1) % 3]]));
    }
  paint.append(edges);
}

void addArrow(Marker& lines, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d along = to - from;
  lines.points.push_back(pointToMsg(from));
  lines.points.push_back(pointToMsg(to));
  if (along.norm() < 1e-6) return;
  const Eigen::Vector3d aside = along.unitOrthogonal() * 0.1 * along.norm();
  for (const double side : {-1.0, 1.0}) {
    lines.points.push_back(pointToMsg(to));
    lines.points.push_back(pointToMsg(to - 0.25 * along + side * aside));
  }
}

void drawField(const Predictor& predictor, const OverlayStyle& style, Painter& paint) {
  const Correction& model = predictor.model();
  Marker& trusted = paint.add("error_field", Marker::LINE_LIST, true);
  Marker faded_ones = trusted;
  trusted.color = kCommandColour;
  trusted.scale.x = style.axis_length / 40.0;
  faded_ones.id = trusted.id + 1;
  faded_ones.color = kGrey;
  faded_ones.scale.x = style.axis_length / 60.0;
  const auto workspace = predictor.makeWorkspace();
  const Eigen::Vector3d low = model.trust.workspace_min, high = model.trust.workspace_max;
  Motion rest;
  rest.pose.q = model.rigid.q.conjugate() * model.mean_orientation;
  for (int i = 0; i < kGrid[0]; ++i)
    for (int j = 0; j < kGrid[1]; ++j)
      for (int k = 0; k < kGrid[2]; ++k) {
        const Eigen::Vector3d share((i + 0.5) / kGrid[0], (j + 0.5) / kGrid[1],
                                    (k + 0.5) / kGrid[2]);
        rest.pose.p = low + share.cwiseProduct(high - low);
        const Prediction said = predictor.predict(rest, *workspace);
        const Eigen::Vector3d to =
            rest.pose.p + style.exaggeration * (said.command.p - rest.pose.p);
        addArrow(said.h_share > kFullShare ? trusted : faded_ones, rest.pose.p, to);
      }
  if (trusted.points.empty()) trusted.action = Marker::DELETE;
  if (faded_ones.points.empty()) faded_ones.action = Marker::DELETE;
  paint.append(faded_ones);
  const std::string scale = style.exaggeration == 1.0
                                ? "true to scale"
                                : format("drawn %g times as long", style.exaggeration);
  paint.text("error_field", true,
             Eigen::Vector3d(high.x(), low.y(), low.z() - 3.0 * style.text_height),
             "the model's correction at rest, " + scale + "; grey: faded", kCommandColour, 0.8);
}

}  // namespace

visualization_msgs::MarkerArray makeTrainingMarkers(const TrainingSamples* samples,
                                                    const Predictor* model,
                                                    const OverlayStyle& style) {
  MarkerArray array;
  OverlayStyle lasting = style;
  lasting.lifetime = 0.0;
  Painter paint(lasting, array);
  paint.add("", Marker::CUBE, true).action = Marker::DELETEALL;
  if (samples) {
    drawKept(*samples, lasting, paint);
    drawRejected(*samples, lasting, paint);
    drawHull(*samples, lasting, paint);
  }
  if (model) drawField(*model, lasting, paint);
  return array;
}

}  // namespace raven_correction
