// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/simulation/debridement_task.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr int kMaxDraws = 1000;  // of a place before the field counts as unreachable

/// The tool's mean orientation, turned about the vertical of the base.
Eigen::Quaterniond turned(const DebridementTaskConfig& config, double turn) {
  return (expRotation({0.0, 0.0, turn}) * config.orientation).normalized();
}

Pose above(const Pose& X_base_tool, double height) {
  return {X_base_tool.p + Eigen::Vector3d(0.0, 0.0, height), X_base_tool.q};
}

}  // namespace

DebridementTask::DebridementTask(const DebridementTaskConfig& config, std::size_t arm,
                                 DebridementCell& cell, FragmentBook& book)
    : config_(config), arm_(arm), cell_(cell), book_(book) {
  if (!(config.turn_limit >= 0.0 && config.round >= 1.0 && config.hover >= 0.0 &&
        config.settle >= 0.0 && config.retry_turn >= 0.0 && config.retry_shift >= 0.0 &&
        config.jaw_time >= 0.0 && config.waiting > 0.0 && config.deviation_limit >= 0.0))
    throw InvalidInput(format(
        "debridement task: turn_limit = %g rad, hover = %g m, settle = %g s, retry_turn = %g "
        "rad, retry_shift = %g m, jaw_time = %g s, deviation_limit = %g m must be >= 0, waiting = "
        "%g s > 0, round = %g "
        ">= 1",
        config.turn_limit, config.hover, config.settle, config.retry_turn, config.retry_shift,
        config.jaw_time, config.deviation_limit, config.waiting, config.round));
  config_.orientation.normalize();  // it is given in rounded numbers
}

Pose DebridementTask::graspPose(const FragmentSighting& fragment, unsigned failed) const {
  const Eigen::Vector3d across = config_.orientation * Eigen::Vector3d::UnitY();
  const Eigen::Vector3d axis =
      config_.X_base_field.q * Eigen::Vector3d(std::cos(fragment.yaw), std::sin(fragment.yaw), 0.0);
  // The jaw is the same after half a turn.
  const double turn = std::remainder(
      std::atan2(axis.y(), axis.x()) + M_PI_2 - std::atan2(across.y(), across.x()), M_PI);
  const bool has_direction = fragment.length > config_.round * fragment.width;
  const double limited =
      has_direction ? std::clamp(turn, -config_.turn_limit, config_.turn_limit) : 0.0;
  const double inwards = limited > 0.0 ? -1.0 : 1.0;  // first where the limit does not matter
  const double side[] = {0.0, inwards, -inwards};     // of an attempt after so many others
  const double otherwise = side[failed % 3];
  const Eigen::Quaterniond orientation =
      turned(config_, std::clamp(limited + otherwise * config_.retry_turn, -config_.turn_limit,
                                 config_.turn_limit));
  const Eigen::Vector3d shift(0.0, otherwise * config_.retry_shift, 0.0);
  return {config_.X_base_field * fragment.p_field + orientation * shift, orientation};
}

/// @return the fragment, if it is still seen where it lay
std::optional<FragmentSighting> DebridementTask::attempt(const FragmentSighting& fragment,
                                                         FragmentRecord& record) {
  const Pose grasp = graspPose(fragment, record.attempts);
  cell_.setJaw(config_.jaw_open, 0.0);
  cell_.move("move_towards_foam", above(grasp, config_.hover), 0.0);
  cell_.move("grasp", grasp, config_.settle);
  ++record.attempts;
  const double predicted = cell_.predictedDeviation();
  record.predicted = std::max(record.predicted, predicted);
  const bool missed = record.attempts > 1;  // so the prediction was wrong
  if (config_.deviation_limit > 0.0 && (predicted > config_.deviation_limit || missed)) {
    record.replans += cell_.replanHere();
  }
  cell_.setJaw(config_.jaw_closed, config_.jaw_time);
  cell_.move("check_pickup", above(grasp, config_.hover), 0.0);
  const FieldPicture picture = cell_.look();
  took_neighbour_ = book_.tookNeighbour(arm_, picture);
  book_.see(picture);
  return book_.stillThere(arm_, picture);
}

void DebridementTask::workOn(const FragmentBook::Choice& choice, FragmentRecord& record) {
  record.p_field = choice.fragment.p_field;
  record.begin = cell_.now();
  FragmentSighting fragment = choice.fragment;
  while (const std::optional<FragmentSighting> left = attempt(fragment, record)) {
    fragment = *left;
    const bool given_up = book_.failed(arm_);
    if (took_neighbour_) {
      cell_.move("move_holding", config_.X_base_rest, 0.0);
      cell_.setJaw(config_.jaw_open, config_.jaw_time);
    } else if (given_up) {
      // Empty, but the other arm may need the room.
      cell_.move("move_empty", config_.X_base_rest, 0.0);
    }
    if (!given_up) continue;
    record.end = cell_.now();
    return;
  }
  record.picked = true;
  cell_.move("move_holding", config_.X_base_rest, 0.0);
  cell_.setJaw(config_.jaw_open, config_.jaw_time);
  record.end = cell_.now();
}

std::vector<FragmentRecord> DebridementTask::run() {
  std::vector<FragmentRecord> records;
  cell_.move("move_to_start", config_.X_base_rest, 0.0);
  cell_.setJaw(config_.jaw_open, config_.jaw_time);
  book_.see(cell_.look());
  for (;;) {
    const FragmentBook::Choice choice = book_.choose(arm_);
    if (choice.next == FragmentBook::Next::kNothing) return records;
    if (choice.next != FragmentBook::Next::kWork) {
      const double begin = cell_.now();
      cell_.wait(config_.waiting);
      if (choice.next == FragmentBook::Next::kWait) waited_ += cell_.now() - begin;
      continue;
    }
    records.emplace_back();
    workOn(choice, records.back());
    book_.leave(arm_);
  }
}

void rehearse(const DebridementTaskConfig& task, const RehearsalConfig& config,
              const std::function<bool(const Pose&)>& isReachable, DebridementCell& cell,
              const std::function<void(unsigned)>& watch) {
  std::mt19937_64 random(config.seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::normal_distribution<double> normal;
  const auto place = [&] {
    for (int draw = 0; draw < kMaxDraws; ++draw) {
      Eigen::Vector3d p = config.centre;
      Eigen::Vector3d tilt;
      for (int i = 0; i < 3; ++i) {
        p(i) += config.half_size(i) * uniform(random);
        tilt(i) = config.tilt * std::clamp(normal(random), -2.0, 2.0);
      }
      const Pose X{task.X_base_field * p,
                   (turned(task, config.turn * uniform(random)) * expRotation(tilt)).normalized()};
      if (isReachable(X) && isReachable(above(X, task.hover))) return X;
    }
    throw InvalidInput(
        format("rehearsal: none of %d random places can be reached; move the field", kMaxDraws));
  };
  for (unsigned i = 0; i < config.fragments; ++i) {
    const Pose X = place();
    cell.move("move_towards_foam", above(X, task.hover), config.dwell);
    cell.move("grasp", X, config.dwell);
    cell.move("check_pickup", above(X, task.hover), config.dwell);
    // Every other time, as the way over the receptacle takes longer and teaches less.
    if (i % 2 == 1) cell.move("move_holding", task.X_base_rest, config.dwell);
    if (watch) watch(i + 1);
  }
}

}  // namespace raven_correction
