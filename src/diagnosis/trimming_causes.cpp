// SPDX-License-Identifier: BSD-3-Clause
// How a selection (selector.h) rids its causes of parameters that say nothing: those of a group
// that may as well be nothing, and those that no value within their range suits.
#include <algorithm>
#include <cmath>

#include "selector.h"

namespace raven_correction {
namespace {

constexpr double kDoubtful = 2.0;  // deviations from nothing of a parameter that leaves its group
constexpr double kAtBound = 1e-3;  // of its range: so close to its end a parameter is at it [-]

/// All columns but one.
Eigen::MatrixXd withoutColumn(const Eigen::MatrixXd& matrix, Eigen::Index column) {
  Eigen::MatrixXd rest(matrix.rows(), matrix.cols() - 1);
  rest << matrix.leftCols(column), matrix.rightCols(rest.cols() - column);
  return rest;
}

}  // namespace

void Selector::takeOut(Member& member, Eigen::Index parameter) {
  const LinearHeldOut linear(problem_, fit_, options_.folds);
  EffectFit fit;
  fit.values = linear.others({parameter, 1, 1});
  fit.jacobian = withoutColumn(fit_.jacobian, parameter);
  const Eigen::VectorXd before = withoutColumn(fit_.values.transpose(), parameter).transpose();
  fit.residual = fit_.residual + fit.jacobian * (fit.values - before) -
                 fit_.jacobian.col(parameter) * fit_.values(parameter);
  const ParameterHandle gone = problem_.parameters[static_cast<std::size_t>(parameter)];
  problem_.simulation = withoutParameters(problem_.simulation, {gone});
  problem_.parameters.erase(problem_.parameters.begin() + parameter);
  problem_.start = fit.values;
  problem_.frozen.resize(0, 0);
  fit.covariance = effectCovariance(problem_, fit);
  fit_ = std::move(fit);
  std::vector<ParameterHandle> rest = member.hypothesis.parameters;
  rest.erase(std::remove(rest.begin(), rest.end(), gone), rest.end());
  member.hypothesis = hypothesisOf(std::move(rest), recording_.robot);
  --member.count;
  for (Member& other : members_)
    if (other.first > parameter) --other.first;
}

bool Selector::takeOutMostDoubtful() {
  Member* most = nullptr;
  Eigen::Index parameter = 0;
  double least = kDoubtful;
  for (Member& member : members_) {
    if (!member.together || member.count < 2) continue;
    for (Eigen::Index i = member.first; i < member.first + member.count; ++i) {
      const double away = std::abs(fit_.values(i)) / std::sqrt(fit_.covariance(i, i));
      if (away >= least) continue;
      most = &member;
      parameter = i;
      least = away;
    }
  }
  if (most) takeOut(*most, parameter);
  return most != nullptr;
}

void Selector::trimGroups() {
  for (bool trimmed = true; trimmed;) {
    trimmed = false;
    while (takeOutMostDoubtful()) trimmed = true;
    if (trimmed) refit();
  }
}

bool Selector::isAtBound(const ParameterHandle& handle, double value) const {
  const EffectParameter parameter = parameterOf(problem_.simulation, handle);
  const double margin = kAtBound * (parameter.upper - parameter.lower);
  // 0 is no value that a cause cannot do without, but no cause.
  return value >= parameter.upper - margin ||
         (parameter.lower < 0.0 && value <= parameter.lower + margin);
}

bool Selector::endsAtBound(const Hypothesis& hypothesis, const EffectFit& fit,
                           Eigen::Index first) const {
  for (std::size_t k = 0; k < hypothesis.amplitudes(); ++k)
    if (isAtBound(hypothesis.parameters[k], fit.values(first + static_cast<Eigen::Index>(k))))
      return true;
  return false;
}

void Selector::releaseAtBounds() {
  const auto release = [&](std::size_t m) {
    Member& member = members_[m];
    const auto amplitudes = static_cast<Eigen::Index>(member.hypothesis.amplitudes());
    for (Eigen::Index k = 0; k < std::min(member.count, amplitudes); ++k) {
      const ParameterHandle handle = member.hypothesis.parameters[static_cast<std::size_t>(k)];
      if (!isAtBound(handle, fit_.values(member.first + k))) continue;
      if (member.together && member.count > 1) {
        released_.push_back(hypothesisOf({handle}, recording_.robot));
        takeOut(member, member.first + k);
        refit();
      } else {
        released_.push_back(member.hypothesis);
        remove(m);
      }
      return true;
    }
    return false;
  };
  for (std::size_t m = 0; m < members_.size();) m = release(m) ? 0 : m + 1;
}

}  // namespace raven_correction
