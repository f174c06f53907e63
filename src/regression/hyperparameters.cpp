// SPDX-License-Identifier: BSD-3-Clause
// The search for hyper-parameters: normalisation, starts, coarse to fine (box_search.h), and back
// to the user's units.
#include "raven_correction/regression/hyperparameters.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "box_search.h"
#include "raven_correction/error.h"
#include "raven_correction/regression/fit_progress.h"
#include "raven_correction/regression/grouped_validation.h"
#include "raven_correction/regression/marginal_likelihood.h"

namespace raven_correction {
namespace {

constexpr double kMinLength = 1e-2;  // in standard deviations of the feature
constexpr double kMaxLength = 1e4;
constexpr double kMinNoiseRatio = 1e-8;
constexpr double kMaxNoiseRatio = 1e3;
constexpr Eigen::Index kStartRows = 256;
constexpr Eigen::Index kCoarsening = 4;      // a coarser search has so many times fewer rows
constexpr Eigen::Index kCoarsestRows = 300;  // and at least so many
constexpr double kTolerance = 2e-3;          // of the log likelihood: far below what data can tell
const double kStillSeen = std::log(4.0);     // log of a length, over the shortest one, that shows

// Features centred and in units of their spread; targets in units of their root mean square.
struct Normalised {
  std::vector<Eigen::Index> active;  // features that vary
  Eigen::VectorXd centre;            // d
  Eigen::VectorXd unit;              // d, > 0
  Eigen::VectorXd target_unit;       // q, > 0
  Eigen::MatrixXd points;            // active x n
  Eigen::MatrixXd targets;           // n x q
};

Normalised normalise(const HyperParameterProblem& problem) {
  const Eigen::Index d = problem.points.rows();
  const Eigen::Index n = problem.points.cols();
  Normalised result;
  result.centre = problem.points.rowwise().mean();
  const Eigen::VectorXd deviation =
      ((problem.points.colwise() - result.centre).rowwise().squaredNorm() / double(n)).cwiseSqrt();
  result.unit.resize(d);
  for (Eigen::Index j = 0; j < d; ++j) {
    const double size = problem.points.row(j).cwiseAbs().maxCoeff();
    if (deviation(j) > 1e-12 * size) {
      result.active.push_back(j);
      result.unit(j) = deviation(j);
    } else {
      result.unit(j) = std::max(1.0, size);
    }
  }
  if (!problem.ard && !result.active.empty()) {
    const double common = std::sqrt(deviation.squaredNorm() / double(result.active.size()));
    result.unit.setConstant(common);
  }
  result.points.resize(Eigen::Index(result.active.size()), n);
  for (std::size_t a = 0; a < result.active.size(); ++a) {
    const Eigen::Index j = result.active[a];
    result.points.row(Eigen::Index(a)) =
        (problem.points.row(j).array() - result.centre(j)) / result.unit(j);
  }
  result.target_unit =
      (problem.targets.colwise().squaredNorm().transpose() / double(n)).cwiseSqrt();
  for (double& unit : result.target_unit)
    if (!(unit > 0.0)) unit = 1.0;
  result.targets = problem.targets * result.target_unit.cwiseInverse().asDiagonal();
  return result;
}

// Negative log posterior per target value; the prior is on the log length scales.
Objective::Criterion negativePosterior(MarginalLikelihood& likelihood, double scale,
                                       double prior_deviation,
                                       const Eigen::VectorXd& prior_centre) {
  return [&likelihood, scale, prior_deviation, prior_centre](const Eigen::VectorXd& x,
                                                             Eigen::VectorXd& gradient) {
    double value = likelihood.evaluate(x, &gradient);
    if (prior_deviation > 0.0) {
      const Eigen::Index lengths = x.size() - 1;
      const Eigen::VectorXd z = (x - prior_centre).head(lengths) / prior_deviation;
      value -= 0.5 * z.squaredNorm();
      gradient.head(lengths) -= z / prior_deviation;
    }
    gradient *= -scale;
    return -scale * value;
  };
}

// The likelihood of evenly spaced rows: representative for time series and random orders alike.
MarginalLikelihood likelihoodOf(const HyperParameterProblem& problem, const Normalised& data,
                                Eigen::Index rows) {
  Eigen::MatrixXd points(data.points.rows(), rows);
  Eigen::MatrixXd targets(rows, data.targets.cols());
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Eigen::Index from = i * data.points.cols() / rows;
    points.col(i) = data.points.col(from);
    targets.row(i) = data.targets.row(from);
  }
  return {problem.kernel, problem.mean, problem.ard, points, targets};
}

Eigen::VectorXd startOf(const HyperParameterProblem& problem, const Normalised& data,
                        int& evaluations) {
  MarginalLikelihood likelihood =
      likelihoodOf(problem, data, std::min(kStartRows, data.points.cols()));
  const double typical = std::sqrt(double(std::max<Eigen::Index>(1, data.points.rows())));
  Eigen::VectorXd start(likelihood.parameters());
  Eigen::VectorXd best;
  double best_value = -std::numeric_limits<double>::infinity();
  for (const double factor : {0.5, 1.0, 2.0, 4.0}) {
    for (const double noise_ratio : {1e-4, 1e-2, 1.0}) {
      start.setConstant(std::log(factor * typical));
      start(start.size() - 1) = std::log(noise_ratio);
      const double value = likelihood.evaluate(start, nullptr);
      ++evaluations;
      if (best.size() == 0 || value > best_value) {
        best_value = value;
        best = start;
      }
    }
  }
  return best;
}

struct SearchBest {
  Eigen::VectorXd x;
  SearchEnd end;
  int evaluations = 0;
};

using Evaluated = std::function<void()>;

Objective objectiveOf(const HyperParameterProblem& problem, MarginalLikelihood& likelihood,
                      const Eigen::VectorXd& prior_centre, const Evaluated& evaluated) {
  return Objective(negativePosterior(likelihood, 1.0 / double(likelihood.targets().size()),
                                     problem.log_length_prior, prior_centre),
                   evaluated);
}

SearchLimits limitsOf(const HyperParameterProblem& problem, const MarginalLikelihood& likelihood) {
  return {problem.max_iterations, kTolerance / double(likelihood.targets().size())};
}

// The best of some searches on few rows: the first from x, the others from random places around it.
SearchBest searchCoarse(const HyperParameterProblem& problem, MarginalLikelihood likelihood,
                        const Eigen::VectorXd& x, const Box& box, const Evaluated& evaluated) {
  std::mt19937_64 engine(problem.seed);
  std::normal_distribution<double> normal;
  SearchBest best;
  best.x = x;
  double best_value = std::numeric_limits<double>::infinity();
  for (int k = 0; k < std::max(1, problem.restarts); ++k) {
    Eigen::VectorXd from = x;
    if (k > 0)
      for (double& value : from) value += normal(engine);
    from = from.cwiseMax(box.lower).cwiseMin(box.upper);
    Objective objective = objectiveOf(problem, likelihood, x, evaluated);
    const SearchEnd end = searchBox(objective, from, box, limitsOf(problem, likelihood));
    best.evaluations += objective.evaluations;
    if (objective.best.size() > 0 && objective.best_value < best_value) {
      best_value = objective.best_value;
      best.x = objective.best;
      best.end = end;
    }
  }
  return best;
}

// From the optimum x of fewer rows to that of more. A feature to which few rows are blind has a
// long length and next to no gradient, and would never come back: it starts from a length that
// still shows, a few times the shortest one, if more rows want it shorter than that. The curvature
// is that of the fewer rows.
SearchBest searchFiner(const HyperParameterProblem& problem, MarginalLikelihood fewer,
                       MarginalLikelihood more, Eigen::VectorXd x,
                       const Eigen::VectorXd& prior_centre, const Box& box,
                       const Evaluated& evaluated) {
  const Eigen::Index lengths = x.size() - 1;
  Objective coarse = objectiveOf(problem, fewer, prior_centre, evaluated);
  Objective objective = objectiveOf(problem, more, prior_centre, evaluated);
  Eigen::VectorXd start = x, gradient;
  start.head(lengths) = x.head(lengths).cwiseMin(x.head(lengths).minCoeff() + kStillSeen);
  if (start != x) {
    objective(start, gradient);
    for (Eigen::Index i = 0; i < lengths; ++i)
      if (!(gradient(i) > 0.0)) start(i) = x(i);
  }
  SearchBest best;
  const SearchLimits limits = limitsOf(problem, more);
  best.end = refineInBox(objective, start, curvatureAt(coarse, start), box, limits);
  if (start != x) {
    objective(x, gradient);
    if (objective.best == x)  // the shorter lengths led astray
      best.end = refineInBox(objective, x, curvatureAt(coarse, x), box, limits);
  }
  best.x = objective.best.size() > 0 ? objective.best : x;
  best.evaluations = objective.evaluations + coarse.evaluations;
  return best;
}

// Grouped validation: a weak pull of the log length scales keeps those finite that do not matter.
constexpr double kTypicalLength = 5.0;  // in standard deviations of the feature
constexpr double kLogLengthSpread = 1.5;
constexpr double kPullWeight = 0.002;  // against an error of about 0.1
constexpr double kStartNoiseRatio = 0.02;

HyperParameterResult learnByValidation(const HyperParameterProblem& problem,
                                       const Evaluated& evaluated) {
  const Normalised data = normalise(problem);
  GroupedValidation::Options options;
  options.kernel = problem.kernel;
  options.max_rows = problem.max_validation_rows;
  options.seed = problem.seed;
  // Blocks of the features that vary, numbered without gaps.
  std::map<int, int> numbers;
  for (const Eigen::Index j : data.active) {
    const int block = !problem.ard                     ? 0
                      : problem.feature_blocks.empty() ? int(j)
                                                       : problem.feature_blocks[std::size_t(j)];
    options.blocks.push_back(numbers.emplace(block, int(numbers.size())).first->second);
  }
  GroupedValidation validation(options, data.points, data.targets, problem.row_groups);
  const Eigen::Index lengths = validation.parameters() - 1;
  const auto criterion = [&](const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
    const Eigen::VectorXd z =
        (x.head(lengths).array() - std::log(kTypicalLength)) / kLogLengthSpread;
    const double pull = kPullWeight / double(lengths);
    const double value = validation.evaluate(x, &gradient) + pull * z.squaredNorm();
    gradient.head(lengths) += 2.0 * pull / kLogLengthSpread * z;
    return value;
  };
  Eigen::VectorXd start = Eigen::VectorXd::Constant(lengths + 1, std::log(kTypicalLength));
  start(lengths) = std::log(kStartNoiseRatio);
  Box box{Eigen::VectorXd::Constant(lengths + 1, -2.0),
          Eigen::VectorXd::Constant(lengths + 1, 6.0)};
  box.lower(lengths) = std::log(1e-5);
  box.upper(lengths) = std::log(10.0);
  Objective objective(criterion, evaluated);
  const SearchEnd end = searchBox(objective, start, box, {std::min(40, problem.max_iterations)});
  const Eigen::VectorXd best = objective.best.size() > 0 ? objective.best : start;

  HyperParameterResult result;
  result.converged = end.converged;
  result.message = end.message;
  result.iterations = end.iterations;
  result.evaluations = objective.evaluations;
  result.length_scales = 1e3 * data.unit;  // of features that are constant: they hardly matter
  for (std::size_t a = 0; a < data.active.size(); ++a)
    result.length_scales(data.active[a]) =
        data.unit(data.active[a]) * std::exp(best(options.blocks[a]));
  result.signal_variance =
      validation.signalVariance(best).cwiseProduct(data.target_unit.cwiseAbs2());
  result.noise_variance = std::exp(best(lengths)) * result.signal_variance;
  result.mean_weights.setZero(1 + problem.points.rows(), problem.targets.cols());
  result.log_marginal_likelihood = std::numeric_limits<double>::quiet_NaN();
  return result;
}

}  // namespace

HyperParameterResult learnHyperParameters(const HyperParameterProblem& problem) {
  return learnHyperParameters(problem, {});
}

HyperParameterResult learnHyperParameters(const HyperParameterProblem& problem,
                                          const std::function<void()>& evaluated) {
  if (problem.criterion == HyperCriterion::kValidation) {
    if (problem.mean != MeanType::kZero)
      throw InvalidInput(
          "grouped validation learns processes with mean zero only; set mean: zero, "
          "or choose the marginal likelihood");
    return learnByValidation(problem, evaluated);
  }
  const Eigen::Index d = problem.points.rows();
  const Eigen::Index n = problem.points.cols();
  const Eigen::Index q = problem.targets.cols();
  const Normalised data = normalise(problem);
  HyperParameterResult result;
  const Eigen::VectorXd start = startOf(problem, data, result.evaluations);
  const Eigen::Index parameters = start.size();
  Eigen::VectorXd best = start;

  if (n < 3 || data.active.empty()) {
    result.message = format("%td rows, %zu features that vary: nothing to learn from, start kept",
                            n, data.active.size());
  } else {
    Box box{Eigen::VectorXd::Constant(parameters, std::log(kMinLength)),
            Eigen::VectorXd::Constant(parameters, std::log(kMaxLength))};
    box.lower(parameters - 1) = std::log(kMinNoiseRatio);
    box.upper(parameters - 1) = std::log(kMaxNoiseRatio);
    // Coarse to fine: the optimum of a quarter of the rows costs little and is near that of all.
    std::vector<Eigen::Index> stages{n};
    while (stages.back() / kCoarsening >= kCoarsestRows)
      stages.push_back(stages.back() / kCoarsening);
    for (auto rows = stages.rbegin(); rows != stages.rend(); ++rows) {
      const SearchBest found =
          rows == stages.rbegin()
              ? searchCoarse(problem, likelihoodOf(problem, data, *rows), start, box, evaluated)
              : searchFiner(problem, likelihoodOf(problem, data, *std::prev(rows)),
                            likelihoodOf(problem, data, *rows), best, start, box, evaluated);
      result.evaluations += found.evaluations;
      result.converged = found.end.converged;
      result.message = found.end.message;
      result.iterations = found.end.iterations;
      best = found.x;
    }
  }

  MarginalLikelihood likelihood = likelihoodOf(problem, data, n);
  result.log_marginal_likelihood =
      likelihood.evaluate(best, nullptr) - double(n) * data.target_unit.array().log().sum();
  result.jitter = std::max(0.0, likelihood.jitter());
  result.length_scales = 1e3 * data.unit;  // of features that are constant: they hardly matter
  for (std::size_t a = 0; a < data.active.size(); ++a) {
    const Eigen::Index j = data.active[a];
    result.length_scales(j) = data.unit(j) * std::exp(best(problem.ard ? Eigen::Index(a) : 0));
  }
  const double noise_ratio = std::exp(best(parameters - 1));
  result.signal_variance = likelihood.signalVariance().cwiseProduct(data.target_unit.cwiseAbs2());
  result.noise_variance = noise_ratio * result.signal_variance;
  result.mean_weights.setZero(1 + d, q);
  const Eigen::MatrixXd& weights = likelihood.meanWeights();  // on normalised features
  if (weights.rows() > 0) result.mean_weights.row(0) = weights.row(0);
  for (Eigen::Index a = 0; a + 1 < weights.rows(); ++a) {
    const Eigen::Index j = data.active[std::size_t(a)];
    result.mean_weights.row(1 + j) = weights.row(1 + a) / data.unit(j);
    result.mean_weights.row(0) -= result.mean_weights.row(1 + j) * data.centre(j);
  }
  result.mean_weights *= data.target_unit.asDiagonal();
  return result;
}

}  // namespace raven_correction
