// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/noise_floor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "raven_correction/diagnosis/residual.h"
#include "raven_correction/geometry/statistics.h"

namespace raven_correction {

Eigen::VectorXd noiseFloor(const Recording& recording, const SimulationConfig& simulation) {
  Recording frames = recording;
  for (Recording::Motion& motion : frames.motions)  // a block of time may have none of its own
    if (!motion.frames.empty()) motion.observations = std::move(motion.frames);
  const ResidualLayout layout = residualLayout(frames);
  const Eigen::VectorXd residual = residuals(frames, layout, simulation);
  struct Point {
    double stamp;
    Eigen::Index offset;
  };
  std::map<std::pair<int, int>, std::vector<Point>> series;  // by channel and motion
  for (const ResidualBlock& block : layout.blocks)
    series[{block.channel, block.motion}].push_back(
        {frames.motions[static_cast<std::size_t>(block.motion)]
             .observations[static_cast<std::size_t>(block.sample)]
             .stamp,
         block.offset});
  std::vector<std::vector<double>> differences(layout.channels.size());
  for (const auto& [key, points] : series) {
    const auto c = static_cast<std::size_t>(key.first);
    for (std::size_t i = 2; i < points.size(); ++i) {
      const double a = points[i - 1].stamp - points[i - 2].stamp;
      const double b = points[i].stamp - points[i - 1].stamp;
      if (!(a > 0.0 && b > 0.0) || std::max(a, b) > 2.0 * std::min(a, b)) continue;
      // The middle sample against the line between its neighbours, of variance 1 +
      // (b^2+a^2)/(a+b)^2.
      const double u = b / (a + b), v = a / (a + b);
      for (int k = 0; k < layout.channels[c].size; ++k) {
        const double away = residual(points[i - 1].offset + k) -
                            u * residual(points[i - 2].offset + k) -
                            v * residual(points[i].offset + k);
        differences[c].push_back(std::abs(away) / std::sqrt(1.0 + u * u + v * v));
      }
    }
  }
  Eigen::VectorXd floor = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(differences.size()),
                                                    std::numeric_limits<double>::quiet_NaN());
  for (std::size_t c = 0; c < differences.size(); ++c)
    if (!differences[c].empty())
      floor(static_cast<Eigen::Index>(c)) = 1.4826 * median(std::move(differences[c]));
  return floor;
}

}  // namespace raven_correction
