// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/dependence.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "delay_dependence.h"
#include "observed_samples.h"
#include "raven_correction/diagnosis/held_out.h"
#include "raven_correction/geometry/statistics.h"
#include "raven_correction/robot/gravity_load.h"
#include "raven_correction/simulation/play.h"

namespace raven_correction {
namespace {

constexpr double kClip = 3.0;    // in robust deviations [-]
constexpr double kRidge = 1e-2;  // per row, of features of unit variance [-]
constexpr double kSlow = 0.02;   // of the peak speed: below it a direction is not certain [-]
constexpr double kPlays[] = {0.02, 0.15};  // widths, of the range of the joint [-]
constexpr double kPi = 3.14159265358979323846;

using Sample = ObservedSample;

/// Features of one group, one column per sample, of zero mean and unit variance.
class Features {
 public:
  explicit Features(std::size_t samples) : samples_(samples) {}
  void add(std::vector<double> values) {
    const double centre = mean(values);
    const double deviation = standardDeviation(values);
    if (!(deviation > 1e-12)) return;
    for (double& v : values) v = (v - centre) / deviation;
    rows_.push_back(std::move(values));
  }
  void addAll(const Features& other) {
    rows_.insert(rows_.end(), other.rows_.begin(), other.rows_.end());
  }
  bool empty() const { return rows_.empty(); }
  Eigen::MatrixXd matrix() const {  // samples x features
    Eigen::MatrixXd m(static_cast<Eigen::Index>(samples_), static_cast<Eigen::Index>(rows_.size()));
    for (std::size_t f = 0; f < rows_.size(); ++f)
      m.col(static_cast<Eigen::Index>(f)) =
          Eigen::Map<const Eigen::VectorXd>(rows_[f].data(), static_cast<Eigen::Index>(samples_));
    return m;
  }

 private:
  std::size_t samples_;
  std::vector<std::vector<double>> rows_;
};

template <typename Function>
std::vector<double> ofEach(const std::vector<Sample>& samples, const Function& function) {
  std::vector<double> values;
  values.reserve(samples.size());
  for (const Sample& sample : samples) values.push_back(function(sample));
  return values;
}

/// Centre, range and peak speed of one joint over the samples.
struct Extent {
  double centre, range, peak;
};
std::vector<Extent> extentsOf(const std::vector<Sample>& samples) {
  std::vector<Extent> extents;
  for (Eigen::Index j = 0; j < samples.front().joints.size(); ++j) {
    const auto q = ofEach(samples, [&](const Sample& s) { return s.joints(j); });
    const auto v = ofEach(samples, [&](const Sample& s) { return std::abs(s.speed(j)); });
    const auto [low, high] = std::minmax_element(q.begin(), q.end());
    extents.push_back(
        {0.5 * (*low + *high), std::max(1e-9, *high - *low), std::max(1e-9, quantile(v, 0.99))});
  }
  return extents;
}

Features positionFeatures(const std::vector<Sample>& samples, const std::vector<Extent>& extents) {
  Features features(samples.size());
  const auto unit = [&](const Sample& s, std::size_t j) {
    return 2.0 * (s.joints(static_cast<Eigen::Index>(j)) - extents[j].centre) / extents[j].range;
  };
  for (std::size_t i = 0; i < extents.size(); ++i) {
    features.add(ofEach(samples, [&](const Sample& s) { return unit(s, i); }));
    for (std::size_t j = i; j < extents.size(); ++j)
      features.add(ofEach(samples, [&](const Sample& s) { return unit(s, i) * unit(s, j); }));
    for (const double waves : {1.5, 3.0}) {
      features.add(
          ofEach(samples, [&](const Sample& s) { return std::sin(waves * kPi * unit(s, i)); }));
      features.add(
          ofEach(samples, [&](const Sample& s) { return std::cos(waves * kPi * unit(s, i)); }));
    }
  }
  return features;
}

Features directionFeatures(const std::vector<Sample>& samples, const std::vector<Extent>& extents) {
  Features features(samples.size());
  for (std::size_t j = 0; j < extents.size(); ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    features.add(ofEach(samples, [&](const Sample& s) {
      return std::tanh(s.speed(row) / (kSlow * extents[j].peak));
    }));
    for (const double width : kPlays) {
      const double half = 0.5 * width * extents[j].range;
      double behind = samples.front().joints(row);
      features.add(ofEach(samples, [&](const Sample& s) {
        behind = play(s.joints(row), behind, half);
        return (s.joints(row) - behind) / half;
      }));
    }
  }
  return features;
}

Features speedFeatures(const std::vector<Sample>& samples, const std::vector<Extent>& extents) {
  Features features(samples.size());
  for (std::size_t j = 0; j < extents.size(); ++j) {
    const auto v = [&](const Sample& s) {
      return s.speed(static_cast<Eigen::Index>(j)) / extents[j].peak;
    };
    features.add(ofEach(samples, v));
    features.add(ofEach(samples, [&](const Sample& s) { return std::abs(v(s)); }));
    features.add(ofEach(samples, [&](const Sample& s) { return v(s) * std::abs(v(s)); }));
  }
  return features;
}

Features loadFeatures(const std::vector<Sample>& samples, const Recording& recording) {
  Features features(samples.size());
  if (!recording.has_kinematics) return features;
  std::vector<Eigen::VectorXd> loads;
  for (const Sample& sample : samples)
    loads.push_back(gravityLoad(recording.robot, JointVector(sample.joints), 0.0));
  for (Eigen::Index j = 0; j < recording.robot.size(); ++j) {
    std::vector<double> load, square;
    for (const Eigen::VectorXd& all : loads) {
      load.push_back(all(j));
      square.push_back(all(j) * all(j));
    }
    features.add(std::move(load));
    features.add(std::move(square));
  }
  return features;
}

Features timeFeatures(const std::vector<Sample>& samples) {
  Features features(samples.size());
  const double start = samples.front().stamp;
  const double duration = std::max(1e-9, samples.back().stamp - start);
  const auto t = [&](const Sample& s) { return (s.stamp - start) / duration; };
  for (const int power : {1, 2, 3})
    features.add(ofEach(samples, [&](const Sample& s) { return std::pow(t(s), power); }));
  for (const int waves : {1, 2, 3, 5}) {
    features.add(
        ofEach(samples, [&](const Sample& s) { return std::sin(2 * kPi * waves * t(s)); }));
    features.add(
        ofEach(samples, [&](const Sample& s) { return std::cos(2 * kPi * waves * t(s)); }));
  }
  return features;
}

Eigen::MatrixXd clipped(const Eigen::MatrixXd& values) {
  return values.cwiseMax(-kClip).cwiseMin(kClip);
}

/// Whitened residuals of every sample, one column per component; what a sample does not
/// have is 0.
Eigen::MatrixXd targetsOf(const std::vector<Sample>& samples, const ResidualLayout& layout,
                          const Eigen::VectorXd& residual, const Eigen::VectorXd& scales,
                          std::vector<int>& channel_of) {
  std::vector<Eigen::Index> first;
  Eigen::Index columns = 0;
  for (std::size_t c = 0; c < layout.channels.size(); ++c) {
    first.push_back(columns);
    if (layout.channels[c].encoder) continue;
    columns += layout.channels[c].size;
    channel_of.insert(channel_of.end(), static_cast<std::size_t>(layout.channels[c].size),
                      static_cast<int>(c));
  }
  Eigen::MatrixXd targets =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(samples.size()), columns);
  for (std::size_t s = 0; s < samples.size(); ++s) {
    for (const std::size_t b : samples[s].blocks) {
      const ResidualBlock& block = layout.blocks[b];
      const auto c = static_cast<std::size_t>(block.channel);
      for (int i = 0; i < layout.channels[c].size; ++i)
        targets(static_cast<Eigen::Index>(s), first[c] + i) =
            residual(block.offset + i) / scales(block.channel);
    }
  }
  return targets;
}

/// Predictions of every sample from the motions of the other folds, mean included.
Eigen::MatrixXd heldOutPredictions(const std::vector<Sample>& samples,
                                   const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets,
                                   int folds) {
  Eigen::MatrixXd X(features.rows(), features.cols() + 1);
  X << Eigen::VectorXd::Ones(features.rows()), features;
  std::vector<Eigen::MatrixXd> A(static_cast<std::size_t>(folds),
                                 Eigen::MatrixXd::Zero(X.cols(), X.cols()));
  std::vector<Eigen::MatrixXd> B(A.size(), Eigen::MatrixXd::Zero(X.cols(), targets.cols()));
  for (std::size_t begin = 0; begin < samples.size();) {
    std::size_t end = begin;
    while (end < samples.size() && samples[end].motion == samples[begin].motion) ++end;
    const auto fold = static_cast<std::size_t>(samples[begin].motion % folds);
    const auto rows = static_cast<Eigen::Index>(end - begin);
    const auto at = static_cast<Eigen::Index>(begin);
    A[fold] += X.middleRows(at, rows).transpose() * X.middleRows(at, rows);
    B[fold] += X.middleRows(at, rows).transpose() * targets.middleRows(at, rows);
    begin = end;
  }
  std::vector<Eigen::MatrixXd> weights;
  for (int k = 0; k < folds; ++k) {
    Eigen::MatrixXd left = Eigen::MatrixXd::Zero(X.cols(), X.cols());
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(X.cols(), targets.cols());
    for (int other = 0; other < folds; ++other) {
      if (other == k) continue;
      left += A[static_cast<std::size_t>(other)];
      right += B[static_cast<std::size_t>(other)];
    }
    left.diagonal().tail(features.cols()).array() += kRidge * left(0, 0);
    left(0, 0) += 1e-9;
    weights.push_back(left.ldlt().solve(right));
  }
  Eigen::MatrixXd predictions(targets.rows(), targets.cols());
  for (std::size_t s = 0; s < samples.size(); ++s)
    predictions.row(static_cast<Eigen::Index>(s)) =
        X.row(static_cast<Eigen::Index>(s)) *
        weights[static_cast<std::size_t>(samples[s].motion % folds)];
  return predictions;
}

/// Mean squares of each motion, channels counting equally.
Eigen::VectorXd squaresOfMotions(const std::vector<Sample>& samples, const Eigen::MatrixXd& error,
                                 int motions) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(motions), count = sum;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    sum(samples[s].motion) += error.row(static_cast<Eigen::Index>(s)).squaredNorm();
    count(samples[s].motion) += 1.0;
  }
  return sum.cwiseQuotient(count);  // nan for a motion without samples
}

}  // namespace

DependenceResult residualDependence(const Recording& recording, const ResidualLayout& layout,
                                    const Eigen::VectorXd& residual, const Eigen::MatrixXd& joints,
                                    const SimulatedSamples& simulated, int folds,
                                    std::uint64_t seed) {
  DependenceResult result;
  const std::vector<Sample> samples = observedSamples(recording, layout, joints);
  if (samples.empty()) return result;
  const Eigen::VectorXd scales = channelScales(layout, residual);
  std::vector<int> channel_of;
  const Eigen::MatrixXd whitened = targetsOf(samples, layout, residual, scales, channel_of);
  const Eigen::MatrixXd targets = clipped(whitened);
  const Eigen::MatrixXd none(targets.rows(), 0);
  const Eigen::MatrixXd constant = heldOutPredictions(samples, none, targets, folds);
  const Eigen::VectorXd before = squaresOfMotions(samples, targets - constant, layout.motions);
  const auto explained = [&](const std::string& name, const Eigen::MatrixXd& predictions) {
    const LossComparison comparison = compareLosses(
        before, squaresOfMotions(samples, targets - predictions, layout.motions), seed);
    return Dependence{name, comparison.share, comparison.lower, comparison.upper};
  };

  const std::vector<Extent> extents = extentsOf(samples);
  const std::pair<const char*, Features> groups[] = {
      {"position", positionFeatures(samples, extents)},
      {"direction", directionFeatures(samples, extents)},
      {"speed", speedFeatures(samples, extents)},
      {"load", loadFeatures(samples, recording)},
      {"time", timeFeatures(samples)}};
  Eigen::MatrixXd velocity(targets.rows(), targets.cols());
  for (std::size_t i = 0; i < samples.size(); ++i)
    velocity.row(static_cast<Eigen::Index>(i)) =
        simulatedVelocity(recording, samples[i], simulated);
  for (std::size_t k = 0; k < channel_of.size(); ++k)
    velocity.col(static_cast<Eigen::Index>(k)) /= scales(channel_of[k]);
  const DelayPrediction delay = delayPredictions(samples, whitened, velocity, folds);
  result.delay = delay.delay;
  result.on_delay = explained("delay", clipped(delay.predictions));
  Features all(samples.size());
  for (const auto& [name, features] : groups) {
    if (features.empty()) continue;
    all.addAll(features);
    result.groups.push_back(
        explained(name, heldOutPredictions(samples, features.matrix(), targets, folds)));
  }
  const Eigen::MatrixXd predictions = heldOutPredictions(samples, all.matrix(), targets, folds);
  result.anything = explained("anything", predictions);
  const auto rmsOf = [&](std::size_t c) {
    double sum = 0.0;
    for (std::size_t k = 0; k < channel_of.size(); ++k)
      if (channel_of[k] == static_cast<int>(c))
        sum += predictions.col(static_cast<Eigen::Index>(k)).squaredNorm();
    return scales(static_cast<Eigen::Index>(c)) *
           std::sqrt(sum / static_cast<double>(samples.size()));
  };
  for (std::size_t c = 0; c < layout.channels.size(); ++c) {
    if (layout.channels[c].encoder) continue;
    if (!recording.has_kinematics)
      result.joint_rms.push_back(rmsOf(c));
    else
      (layout.channels[c].unit == "m" ? result.position_rms : result.orientation_rms) = rmsOf(c);
  }
  return result;
}

}  // namespace raven_correction
