// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/fragment_book.h"

#include <algorithm>
#include <tuple>

#include "raven_correction/error.h"

namespace raven_correction {

FragmentBook::FragmentBook(const FragmentBookConfig& config, std::vector<FieldPart> parts)
    : config_(config), parts_(std::move(parts)), claims_(parts_.size()) {
  if (parts_.empty()) throw InvalidInput("fragment book: no arm");
  if (!(config_.same >= 0.0 && config_.separation >= 0.0 && config_.reach >= 0.0 &&
        config_.attempts > 0))
    throw InvalidInput(
        format("fragment book: same = %g m, separation = %g m and reach = %g m must be >= 0, "
               "attempts = %u > 0",
               config_.same, config_.separation, config_.reach, config_.attempts));
}

void FragmentBook::see(const FieldPicture& picture) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (picture.stamp >= seen_.stamp) seen_ = picture;
}

unsigned FragmentBook::attemptsAt(const Eigen::Vector3d& p_field) const {
  unsigned attempts = 0;
  for (const Tried& tried : tried_)
    if ((tried.p_field - p_field).norm() <= config_.same)
      attempts = std::max(attempts, tried.attempts);
  return attempts;
}

bool FragmentBook::tooNear(std::size_t arm, const Eigen::Vector3d& p_field) const {
  for (std::size_t other = 0; other < claims_.size(); ++other)
    if (other != arm && claims_[other] &&
        (claims_[other]->p_field - p_field).head<2>().norm() < config_.separation)
      return true;
  return false;
}

FragmentBook::Choice FragmentBook::choose(std::size_t arm) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const FieldPart& part = parts_.at(arm);
  Choice choice;
  const FragmentSighting* best = nullptr;
  std::tuple<bool, unsigned, double> best_rank;
  for (const FragmentSighting& fragment : seen_.fragments) {
    if (fragment.p_field.x() < part.lower || fragment.p_field.x() >= part.upper) continue;
    const unsigned tried = attemptsAt(fragment.p_field);
    if (tried >= config_.attempts) continue;
    if (tooNear(arm, fragment.p_field)) {
      choice.next = Next::kWait;
      continue;
    }
    const std::tuple<bool, unsigned, double> rank{fragment.partly_hidden, tried,
                                                  (fragment.p_field - part.p_field_home).norm()};
    if (best != nullptr && best_rank <= rank) continue;
    best = &fragment;
    best_rank = rank;
  }
  if (best == nullptr) {
    for (std::size_t other = 0; other < claims_.size(); ++other)
      if (other != arm && claims_[other] && choice.next == Next::kNothing)
        choice.next = Next::kIdle;
    return choice;
  }
  choice.next = Next::kWork;
  choice.fragment = *best;
  choice.tried = std::get<1>(best_rank);
  claims_[arm] = *best;
  return choice;
}

std::optional<FragmentSighting> FragmentBook::stillThere(std::size_t arm,
                                                         const FieldPicture& picture) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!claims_.at(arm)) return std::nullopt;
  for (const FragmentSighting& fragment : picture.fragments)
    if ((fragment.p_field - claims_[arm]->p_field).norm() <= config_.same) return fragment;
  return std::nullopt;
}

bool FragmentBook::tookNeighbour(std::size_t arm, const FieldPicture& now) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!claims_.at(arm)) return false;
  const Eigen::Vector3d& own = claims_[arm]->p_field;
  const auto isAmong = [&](const FragmentSighting& fragment, const FieldPicture& picture) {
    return std::any_of(picture.fragments.begin(), picture.fragments.end(),
                       [&](const FragmentSighting& other) {
                         return (other.p_field - fragment.p_field).norm() <= config_.same;
                       });
  };
  return std::any_of(
      seen_.fragments.begin(), seen_.fragments.end(), [&](const FragmentSighting& fragment) {
        const double away = (fragment.p_field - own).norm();
        return away > config_.same && away <= config_.reach && !isAmong(fragment, now);
      });
}

bool FragmentBook::failed(std::size_t arm) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!claims_.at(arm)) throw InvalidInput(format("fragment book: arm %zu works on nothing", arm));
  const Eigen::Vector3d p_field = claims_[arm]->p_field;
  for (Tried& tried : tried_)
    if ((tried.p_field - p_field).norm() <= config_.same)
      return ++tried.attempts >= config_.attempts;
  tried_.push_back({p_field, 1});
  return config_.attempts == 1;
}

void FragmentBook::leave(std::size_t arm) {
  const std::lock_guard<std::mutex> lock(mutex_);
  claims_.at(arm).reset();
}

unsigned FragmentBook::givenUp() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return static_cast<unsigned>(std::count_if(tried_.begin(), tried_.end(), [this](const Tried& t) {
    return t.attempts >= config_.attempts;
  }));
}

}  // namespace raven_correction
