// SPDX-License-Identifier: BSD-3-Clause
// ./run bench fit_simulation DATASET --simulation START.yaml -o FITTED.yaml: parameters of a
// simulation from a measured session, so that anybody can repeat how a shipped file came about
// (doc/simulation.md has the commands). Fits every effect parameter of START.yaml that is not 0, by
// robust damped least squares, on the trajectories that are not held out. Finding out which effects
// there are is the room `diagnosis`.
#include <CLI/CLI.hpp>
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "raven_correction/dataset/dataset_directory.h"
#include "raven_correction/dataset/split.h"
#include "raven_correction/dataset/synchronisation.h"
#include "raven_correction/error.h"
#include "raven_correction/simulation/session.h"

namespace {

using namespace raven_correction;  // NOLINT: a program of one file

constexpr double kRotationLength = 0.05;  // converts residuals in rad to m
constexpr double kRotationWindow =
    1.05;  // observations turned by more were no poses of the tool [rad]

struct Arguments {
  std::string dataset, simulation, output, stage = "all";
  int iterations = 15;
  std::size_t every = 1;
  double scale = 0.004;
};

/// One trajectory: what was sent, what was seen, and when.
struct Target {
  const PoseStream* commands;
  PoseStream encoders, observations;
};

std::vector<Target> targetsOf(const Dataset& dataset, std::size_t every) {
  const HoldOut hold_out{0, 5};
  std::vector<Target> targets;
  for (std::size_t i = 0; i < dataset.trajectories.size(); ++i) {
    if (hold_out.tests(i)) continue;
    const Trajectory& trajectory = dataset.trajectories[i];
    Target target{&trajectory.commands, {}, {}};
    const auto thin = [every](const PoseStream& stream) {
      const PoseStream screened = screenObservations(stream).samples;
      PoseStream thinned;
      for (std::size_t k = 0; k < screened.size(); k += every) thinned.push_back(screened[k]);
      return thinned;
    };
    target.encoders = thin(trajectory.encoders);
    target.observations = thin(trajectory.observations);
    targets.push_back(std::move(target));
  }
  return targets;
}

/// Residuals of one stream, six per sample [m]; a trajectory that cannot be replayed has zeros.
void append(SimulatedArm& arm, const PoseStream& commands, const PoseStream& seen, bool encoders,
            std::vector<double>& residuals) {
  std::vector<double> instants;
  for (const StampedPose& sample : seen) instants.push_back(sample.stamp);
  const std::vector<ReplaySample> samples = replay(arm, commands, instants);
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const Pose& simulated = encoders ? samples[k].measured : samples[k].tool;
    const Eigen::Vector3d p = simulated.p - seen[k].pose.p;
    const Eigen::Vector3d r =
        kRotationLength * logRotation(seen[k].pose.q.conjugate() * simulated.q);
    for (int i = 0; i < 3; ++i) residuals.push_back(p(i));
    for (int i = 0; i < 3; ++i) residuals.push_back(r(i));
  }
}

Eigen::VectorXd residualsOf(const SimulationConfig& config, const std::vector<Target>& targets,
                            const std::string& stage) {
  SimulatedArm arm(config);
  std::vector<double> residuals;
  for (const Target& target : targets) {
    const bool drive = stage == "drive";
    append(arm, *target.commands, drive ? target.encoders : target.observations, drive, residuals);
  }
  return Eigen::Map<Eigen::VectorXd>(residuals.data(), static_cast<Eigen::Index>(residuals.size()));
}

/// Square roots of the Cauchy weights, one per pose: 1 / (1 + |r|^2 / scale^2); 0 where the
/// orientation is no pose of the tool.
Eigen::VectorXd weightsOf(const Eigen::VectorXd& residuals, double scale) {
  Eigen::VectorXd weights(residuals.size());
  for (Eigen::Index k = 0; k < residuals.size(); k += 6) {
    const double squared = residuals.segment<6>(k).squaredNorm() / (scale * scale);
    const bool wrong = residuals.segment<3>(k + 3).norm() > kRotationLength * kRotationWindow * 2.0;
    weights.segment<6>(k).setConstant(wrong ? 0.0 : 1.0 / std::sqrt(1.0 + squared));
  }
  return weights;
}

/// sum of scale^2 log(1 + |r|^2 / scale^2) per pose, as a mean [m^2].
double costOf(const Eigen::VectorXd& residuals, double scale) {
  double sum = 0.0;
  for (Eigen::Index k = 0; k < residuals.size(); k += 6)
    sum += std::log1p(residuals.segment<6>(k).squaredNorm() / (scale * scale));
  return scale * scale * sum / static_cast<double>(residuals.size() / 6);
}

bool isDrive(const Effect& effect) {
  return effect.stage() == EffectStage::kCommand || effect.stage() == EffectStage::kDrive;
}

std::vector<Eigen::Index> freeParameters(const SimulationConfig& config, const std::string& stage) {
  std::vector<Eigen::Index> chosen;
  Eigen::Index next = 0;
  for (const auto& effect : config.effects)
    for (const EffectParameter& parameter : effect->parameters()) {
      if (parameter.value != 0.0 && (stage == "all" || isDrive(*effect))) chosen.push_back(next);
      ++next;
    }
  return chosen;
}

double stepOf(const EffectParameter& parameter) {
  // Large enough to see past the kinks of plays, small against the range.
  return std::min(std::max(0.02 * std::abs(parameter.value), 1e-5 * parameter.upper),
                  0.1 * parameter.upper);
}

void fit(const Arguments& arguments) {
  SimulationConfig config = loadSimulationConfig(arguments.simulation);
  const Dataset dataset = readDatasetDirectory(arguments.dataset);
  const std::vector<Target> targets = targetsOf(dataset, arguments.every);
  const std::vector<Eigen::Index> chosen = freeParameters(config, arguments.stage);
  if (chosen.empty()) throw InvalidInput("no parameter to fit: every one of this stage is 0");
  const std::vector<std::string> labels = parameterLabels(config);
  Eigen::VectorXd residuals = residualsOf(config, targets, arguments.stage);
  double cost = costOf(residuals, arguments.scale);
  double damping = 1e-2;
  std::printf("%zu parameters, %ld poses, root of the cost %.4f mm\n", chosen.size(),
              static_cast<long>(residuals.size() / 6), 1e3 * std::sqrt(cost));
  const auto n = static_cast<Eigen::Index>(chosen.size());
  for (int iteration = 0; iteration < arguments.iterations; ++iteration) {
    const std::vector<EffectParameter> parameters = parameterList(config);
    const Eigen::VectorXd values = parameterVector(config);
    const Eigen::VectorXd weights = weightsOf(residuals, arguments.scale);
    Eigen::MatrixXd J(residuals.size(), n);
#pragma omp parallel for schedule(dynamic)
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Index place = chosen[static_cast<std::size_t>(i)];
      const EffectParameter& parameter = parameters[static_cast<std::size_t>(place)];
      double step = stepOf(parameter);
      if (parameter.value + step > parameter.upper) step = -step;
      Eigen::VectorXd moved = values;
      moved(place) += step;
      J.col(i) =
          (residualsOf(withParameters(config, moved), targets, arguments.stage) - residuals) / step;
    }
    const Eigen::MatrixXd weighted = weights.asDiagonal() * J;
    const Eigen::MatrixXd H = weighted.transpose() * weighted;
    const Eigen::VectorXd g = weighted.transpose() * weights.cwiseProduct(residuals);
    const double before = cost;
    for (int trial = 0; trial < 6; ++trial) {
      Eigen::MatrixXd damped = H;
      damped.diagonal() += damping * H.diagonal();
      damped.diagonal().array() += 1e-12 * H.diagonal().maxCoeff();
      const Eigen::VectorXd change = -damped.ldlt().solve(g);
      Eigen::VectorXd moved = values;
      for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::Index place = chosen[static_cast<std::size_t>(i)];
        const EffectParameter& parameter = parameters[static_cast<std::size_t>(place)];
        moved(place) = std::clamp(values(place) + change(i), parameter.lower, parameter.upper);
        // A parameter that is 0 would no longer count as chosen in the next run.
        if (moved(place) == 0.0) moved(place) = 1e-6 * parameter.upper;
      }
      const SimulationConfig candidate = withParameters(config, moved);
      const Eigen::VectorXd tried = residualsOf(candidate, targets, arguments.stage);
      const double tried_cost = costOf(tried, arguments.scale);
      if (tried_cost < cost) {
        config = candidate;
        residuals = tried;
        cost = tried_cost;
        damping = std::max(1e-6, 0.3 * damping);
        break;
      }
      damping *= 4.0;
    }
    std::printf("%3d  %.4f mm  damping %.1e\n", iteration + 1, 1e3 * std::sqrt(cost), damping);
    std::fflush(stdout);
    if (!(cost < before * (1.0 - 1e-4))) break;
  }
  const Eigen::VectorXd values = parameterVector(config);
  for (const Eigen::Index place : chosen)
    std::printf("%-45s %.5g\n", labels[static_cast<std::size_t>(place)].c_str(), values(place));
  saveSimulationConfig(config, arguments.output);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Fits the non-zero effect parameters of a simulation to a measured session");
  app.add_option("DATASET", arguments.dataset, "data set directory")->required();
  app.add_option("--simulation", arguments.simulation, "where to start")->required();
  app.add_option("-o,--output", arguments.output, "simulation file to write")->required();
  app.add_option("--stage", arguments.stage,
                 "drive: delay and drive, to the encoders; all (default): everything, to the "
                 "observations")
      ->check(CLI::IsMember({"drive", "all"}));
  app.add_option("--iterations", arguments.iterations, "at most so many; default 15");
  app.add_option("--every", arguments.every, "uses every n-th sample; default 1")
      ->check(CLI::Range(1, 1000));
  app.add_option("--scale", arguments.scale, "residuals beyond it lose weight [m]; default 0.004");
  CLI11_PARSE(app, argc, argv);
  try {
    fit(arguments);
  } catch (const InvalidInput& error) {
    std::fprintf(stderr, "fit_simulation: %s\n", error.what());
    return 2;
  }
  return 0;
}
