// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/diagnosis/screening.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "linear_residual.h"
#include "parallel.h"

namespace raven_correction {
namespace {

constexpr double kCollinear = 1e-5;       // of a column that the fit so far does not explain [-]
constexpr std::size_t kPeriodicMost = 2;  // periods per joint
constexpr double kPeriodsTried = 100.0;   // about so many are searched for each joint

/// The weighted residual, and what the parameters in the fit so far can do about anything.
class LinearModel {
 public:
  LinearModel(const EffectFitProblem& problem, const EffectFit& fit)
      : root_(
            rowWeights(*problem.layout, fit.residual, channelScales(*problem.layout, fit.residual))
                .cwiseSqrt()),
        residual_(root_.cwiseProduct(fit.residual)),
        jacobian_(root_.asDiagonal() * fit.jacobian) {
    Eigen::MatrixXd H = jacobian_.transpose() * jacobian_;
    if (H.rows() == 0) return;
    H.diagonal().array() += 1e-9 * H.trace() / static_cast<double>(H.rows());
    inverse_.compute(H);
  }

  /// @param columns  change of the residual for each amplitude at its start
  /// @param scale    of the amplitudes, relative to their starts
  /// @param others   step of the parameters in the fit so far
  /// @return explained share; 0 where the fit so far explains the columns
  double explain(const Eigen::MatrixXd& columns, Eigen::VectorXd& scale,
                 Eigen::VectorXd& others) const {
    const Eigen::MatrixXd D = root_.asDiagonal() * columns;
    Eigen::MatrixXd S = D.transpose() * D;
    Eigen::VectorXd b = D.transpose() * residual_;
    const Eigen::VectorXd full = S.diagonal();
    Eigen::MatrixXd cross;
    Eigen::VectorXd slope;
    if (jacobian_.cols() > 0) {
      cross = jacobian_.transpose() * D;
      slope = jacobian_.transpose() * residual_;
      const Eigen::MatrixXd solved = inverse_.solve(cross);
      S -= cross.transpose() * solved;
      b -= solved.transpose() * slope;
    }
    others = Eigen::VectorXd::Zero(jacobian_.cols());
    scale = Eigen::VectorXd::Zero(D.cols());
    if (!(full.maxCoeff() > 0.0) || (S.diagonal().array() <= kCollinear * full.array()).all())
      return 0.0;
    S.diagonal() += kCollinear * full;
    scale = -S.ldlt().solve(b);
    if (jacobian_.cols() > 0) others = -inverse_.solve(slope + cross * scale);
    return -b.dot(scale) / residual_.squaredNorm();
  }

 private:
  Eigen::VectorXd root_, residual_;
  Eigen::MatrixXd jacobian_;
  Eigen::LDLT<Eigen::MatrixXd> inverse_;
};

/// One simulation to run: one amplitude of a hypothesis at one of its starts.
struct Trial {
  std::size_t hypothesis = 0, start = 0;
  Eigen::VectorXd values;  // of the hypothesis' parameters
  Eigen::VectorXd change;  // of the residual
};

Eigen::VectorXd clipped(const EffectFitProblem& problem,
                        const std::vector<ParameterHandle>& parameters, Eigen::VectorXd values) {
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const EffectParameter parameter =
        parameterOf(problem.simulation, parameters[static_cast<std::size_t>(i)]);
    values(i) = std::clamp(values(i), parameter.lower, parameter.upper);
  }
  return values;
}

/// Whether its amplitude is a limit, which may change the joints by far too much for a derivative.
bool limits(const SimulationConfig& here, const Hypothesis& hypothesis) {
  return isLimit(hypothesis.effect, parameterOf(here, hypothesis.parameters.front()).symbol);
}

/// Derivative of the residual by all parameters of one effect, from its nominal values.
Eigen::MatrixXd sensitivityTo(const EffectFitProblem& problem, const SimulationConfig& here,
                              const EffectFit& fit,
                              const std::vector<ParameterHandle>& parameters) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i)
    values(static_cast<Eigen::Index>(i)) = parameterOf(here, parameters[i]).value;
  return residualJacobian(*problem.recording, *problem.layout, here, parameters, values,
                          fit.residual);
}

std::vector<ParameterHandle> handles(const std::string& effect, int first, int count) {
  std::vector<ParameterHandle> all;
  for (int i = 0; i < count; ++i) all.push_back({effect, first + i});
  return all;
}

/// Starts of every hypothesis; `extra` counts the periods and instants that were searched.
std::vector<std::vector<Eigen::VectorXd>> allStarts(const EffectFitProblem& problem,
                                                    const SimulationConfig& here,
                                                    const EffectFit& fit,
                                                    const std::vector<Hypothesis>& hypotheses,
                                                    const RecordingSummary& summary,
                                                    std::size_t& extra) {
  std::vector<std::vector<Eigen::VectorXd>> starts(hypotheses.size());
  Eigen::MatrixXd joints;
  ResidualView view{problem.recording, problem.layout,
                    &summary,          &fit.residual,
                    &joints,           channelScales(*problem.layout, fit.residual)};
  std::vector<std::size_t> periodic;
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    const Hypothesis& hypothesis = hypotheses[h];
    if (hypothesis.effect == "pulley_eccentricity") {
      periodic.push_back(h);
      extra += static_cast<std::size_t>(kPeriodsTried);
    } else if (hypothesis.effect == "registration_shift") {
      starts[h] =
          shiftStarts(view, sensitivityTo(problem, here, fit, handles("base_registration", 0, 6)));
      extra += static_cast<std::size_t>(problem.layout->motions);
    } else {
      starts[h] = startingPoints(hypothesis, summary, here);
    }
  }
  if (periodic.empty()) return starts;
  SimulatedSamples simulated;
  residuals(*problem.recording, *problem.layout, here, &simulated);
  joints = std::move(simulated.joints);
  const Eigen::MatrixXd to_offsets = sensitivityTo(
      problem, here, fit, handles("joint_offset", 0, problem.recording->robot.size()));
  parallelFor(static_cast<int>(periodic.size()), [&](int index) {
    const std::size_t h = periodic[static_cast<std::size_t>(index)];
    const int joint = hypotheses[h].joints.front();
    starts[h] = periodicStarts(view, joint, to_offsets.col(joint), kPeriodicMost);
  });
  return starts;
}

}  // namespace

Screening screen(const EffectFitProblem& problem, const EffectFit& fit,
                 const std::vector<Hypothesis>& hypotheses, const RecordingSummary& summary) {
  const SimulationConfig here = withValues(problem.simulation, problem.parameters, fit.values);
  Screening screening;
  const std::vector<std::vector<Eigen::VectorXd>> starts =
      allStarts(problem, here, fit, hypotheses, summary, screening.starts);

  std::vector<Trial> trials;
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    for (std::size_t s = 0; s < starts[h].size(); ++s) {
      ++screening.starts;
      const auto amplitudes = static_cast<Eigen::Index>(hypotheses[h].amplitudes());
      for (Eigen::Index a = 0; a < amplitudes; ++a) {
        Trial trial{h, s, starts[h][s], {}};
        for (Eigen::Index other = 0; other < amplitudes; ++other)
          if (other != a) trial.values(other) = 0.0;
        trials.push_back(std::move(trial));
      }
    }
  }
  SimulatedSamples simulated;
  residuals(*problem.recording, *problem.layout, here, &simulated);
  std::unique_ptr<LinearResidual> by_joints;
  if (!needsLoad(here))
    by_joints = std::make_unique<LinearResidual>(*problem.recording, *problem.layout, here,
                                                 simulated, fit.residual);
  parallelFor(static_cast<int>(trials.size()), [&](int index) {
    const auto t = static_cast<std::size_t>(index);
    Trial& trial = trials[t];
    const Hypothesis& hypothesis = hypotheses[trial.hypothesis];
    const SimulationConfig with = withValues(here, hypothesis.parameters,
                                             clipped(problem, hypothesis.parameters, trial.values));
    if (leavesJointsAlone(here, hypothesis.effect))
      trial.change =
          residualsOfJoints(*problem.recording, with, simulated, fit.residual) - fit.residual;
    else if (by_joints && !needsLoad(with) && !limits(here, hypothesis))
      trial.change = by_joints->changeTo(with);
    else
      trial.change = residuals(*problem.recording, *problem.layout, with) - fit.residual;
  });

  const LinearModel model(problem, fit);
  std::vector<Candidate> best(hypotheses.size());
  std::vector<std::size_t> begin(hypotheses.size() + 1, 0);  // of the trials of each hypothesis
  for (const Trial& trial : trials) ++begin[trial.hypothesis + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  parallelFor(static_cast<int>(hypotheses.size()), [&](int index) {
    const auto h = static_cast<std::size_t>(index);
    const Hypothesis& hypothesis = hypotheses[h];
    for (std::size_t t = begin[h]; t < begin[h + 1];) {
      const auto amplitudes = static_cast<Eigen::Index>(hypothesis.amplitudes());
      Eigen::MatrixXd columns(problem.layout->size, amplitudes);
      for (Eigen::Index a = 0; a < amplitudes; ++a)
        columns.col(a) = trials[t + static_cast<std::size_t>(a)].change;
      Eigen::VectorXd start = starts[h][trials[t].start];
      t += static_cast<std::size_t>(amplitudes);
      Eigen::VectorXd scale, others;
      const double share = model.explain(columns, scale, others);
      bool impossible = false;  // it would have to work the other way round
      for (Eigen::Index a = 0; a < amplitudes; ++a) {
        const EffectParameter parameter =
            parameterOf(here, hypothesis.parameters[static_cast<std::size_t>(a)]);
        impossible |= amplitudes == 1 && parameter.lower >= 0.0 && scale(a) <= 0.0;
        // A limit acts the other way round: the smaller it is, the more it does.
        if (!isLimit(hypothesis.effect, parameter.symbol)) start(a) *= scale(a);
      }
      if (impossible || share <= best[h].share) continue;
      best[h] = {hypothesis, clipped(problem, hypothesis.parameters, start),
                 clipped(problem, problem.parameters, fit.values + others), share};
    }
  });
  for (Candidate& candidate : best)
    if (candidate.share > 0.0) screening.candidates.push_back(std::move(candidate));
  std::stable_sort(screening.candidates.begin(), screening.candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.share > b.share; });
  return screening;
}

}  // namespace raven_correction
