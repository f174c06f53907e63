// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/correction/training.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>
#include <iterator>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "raven_correction/correction/physics.h"
#include "raven_correction/dataset/speed_delay.h"
#include "raven_correction/error.h"
#include "raven_correction/geometry/rigid_fit.h"
#include "raven_correction/regression/fit_progress.h"

namespace raven_correction {
namespace {

/// FNV-1a, 64 bit, over the bytes of numbers. Source: draft-eastlake-fnv-17.
class Hash {
 public:
  void add(const double* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      unsigned char bytes[sizeof(double)];
      std::memcpy(bytes, &values[i], sizeof(double));
      for (const unsigned char byte : bytes) state_ = (state_ ^ byte) * 0x100000001b3ULL;
    }
  }
  void add(const Pose& pose) {
    add(pose.p.data(), 3);
    add(pose.q.coeffs().data(), 4);
  }
  std::string text() const { return format("%016llx", static_cast<unsigned long long>(state_)); }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325ULL;
};

std::string makeId(double now, const std::string& hash) {
  const auto seconds = static_cast<std::time_t>(now);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32];
  std::strftime(text, sizeof(text), "%Y%m%dT%H%M%SZ", &utc);
  return std::string(text) + "-" + hash.substr(hash.size() - 6);
}

SynchronisationOptions synchronisationOf(const TrainingConfig& config) {
  SynchronisationOptions options;
  options.max_gap = config.max_gap;
  options.max_gap_periods = config.max_gap_periods;
  return options;
}

double resolveDelay(const Dataset& dataset, const TrainingConfig& config, DelayResult& estimate) {
  if (!config.estimate_delay) return config.fixed_delay;
  DelayProblem problem;
  problem.max = config.delay_max;
  problem.max_gap = commandGapLimit(dataset, config);
  if (!(problem.max_gap > 0.0)) return 0.0;  // synchronise() will say what is missing
  estimate = estimateDelay(dataset, problem);
  return estimate.delay;
}

/// nan where speeds do not tell it.
double speedDelayOf(const Dataset& dataset, const TrainingConfig& config) {
  SpeedDelayProblem problem;
  problem.min = -0.1;  // clocks may differ
  problem.max = std::max(problem.max, config.delay_max);
  const DelayResult estimate = estimateSpeedDelay(dataset, problem);
  return estimate.status == DelayResult::Status::kOk ? estimate.delay
                                                     : std::numeric_limits<double>::quiet_NaN();
}

/// The pairs that survived cleaning, or as many of them as were asked for, in order.
std::vector<std::size_t> learntFrom(const TrainingPairs& pairs, const std::vector<Fate>& fates,
                                    const TrainingConfig& config) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < fates.size(); ++i)
    if (fates[i] == Fate::kKept) kept.push_back(i);
  if (config.max_pairs == 0 || kept.size() <= config.max_pairs) return kept;
  std::mt19937_64 random(config.process.seed);
  std::vector<std::size_t> drawn;
  if (config.draw == TrainingConfig::Draw::kPairs) {
    std::sample(kept.begin(), kept.end(), std::back_inserter(drawn), config.max_pairs, random);
    return drawn;
  }
  std::map<std::size_t, std::vector<std::size_t>> of_trajectory;
  for (const std::size_t i : kept) of_trajectory[pairs.samples[i].trajectory].push_back(i);
  std::vector<std::size_t> order;
  for (const auto& entry : of_trajectory) order.push_back(entry.first);
  std::shuffle(order.begin(), order.end(), random);
  for (const std::size_t trajectory : order)
    for (const std::size_t i : of_trajectory[trajectory])
      if (drawn.size() < config.max_pairs) drawn.push_back(i);
  std::sort(drawn.begin(), drawn.end());
  return drawn;
}

/// What the process is learnt about, of every kept pair: x_G, or what physics says; and, of
/// physics, how good it is. Nothing where it does not reach: such a pair is not learnt from.
std::vector<std::optional<Pose>> meansOf(const TrainingPairs& pairs,
                                         const std::vector<std::size_t>& kept,
                                         const TrainingConfig& config, const Correction& model,
                                         TrainingResult& result) {
  std::vector<std::optional<Pose>> means(kept.size());
  const std::optional<InverseArm> physics = inverseArmOf(model.physics);
  double position = 0.0, angle = 0.0;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const std::size_t i = kept[k];
    if (!physics) {
      means[k] = model.rigid * pairs.samples[i].observation;
      continue;
    }
    const InverseArm::Answer answer = physics->solve(pathOf(pairs.motions[i], config.motion));
    if (!answer.reached) {
      ++result.out_of_reach;
      continue;
    }
    means[k] = answer.command;
    const auto left = correctionBetween(answer.command, pairs.samples[i].command);
    position += left.head<3>().squaredNorm();
    angle += left.tail<3>().squaredNorm();
  }
  if (!physics) return means;
  if (2 * result.out_of_reach > kept.size())
    throw InvalidInput(format(
        "simulation %s: its robot does not reach %zu of %zu observed poses; is it the simulation "
        "of another robot or arm, are positions in millimetres?",
        result.simulation.c_str(), result.out_of_reach, kept.size()));
  const auto reached = static_cast<double>(kept.size() - result.out_of_reach);
  result.physics_rms_position = std::sqrt(position / reached);
  result.physics_rms_angle = std::sqrt(angle / reached);
  return means;
}

}  // namespace

std::string describe(const FateCounts& fates) {
  std::string text = format("%zu kept", fates[Fate::kKept]);
  std::string rejected;
  for (std::size_t i = 1; i < fates.count.size(); ++i)
    if (fates.count[i] > 0)
      rejected += format("%s%zu %s", rejected.empty() ? "" : ", ", fates.count[i],
                         fateName(static_cast<Fate>(i)));
  return rejected.empty() ? text : text + "; rejected: " + rejected;
}

Dataset selectFold(const Dataset& dataset, const HoldOut& hold_out, bool tests) {
  Dataset selected = dataset;
  selected.trajectories.clear();
  for (std::size_t i = 0; i < dataset.trajectories.size(); ++i)
    if (hold_out.tests(i) == tests) selected.trajectories.push_back(dataset.trajectories[i]);
  return selected;
}

double commandGapLimit(const Dataset& dataset, const TrainingConfig& config) {
  return commandGapLimit(dataset, synchronisationOf(config));
}

TrainingPairs makePairs(const Dataset& dataset, const TrainingConfig& config, double delay) {
  SynchronisationOptions options = synchronisationOf(config);
  options.delay = delay;
  const std::vector<SynchronisedTrajectory> trajectories = synchronise(dataset, options);
  TrainingPairs pairs;
  MotionOptions speed_options;  // of the speed limits: the same whatever the features are
  speed_options.velocity = VelocityKind::kCausal;
  speed_options.max_gap = config.motion.max_gap;
  MotionEstimator estimator(config.motion);
  for (std::size_t k = 0; k < trajectories.size(); ++k) {
    const SynchronisedTrajectory& trajectory = trajectories[k];
    const std::vector<Motion> motions =
        motionsOf(trajectory.observations.samples, config.motion, estimator);
    const std::vector<Motion> speeds = motionsOf(trajectory.observations.samples, speed_options);
    for (const CommandPair& pair : trajectory.pairs) {
      pairs.samples.push_back({k, trajectory.observations.samples[pair.sample].pose, pair.command,
                               speeds[pair.sample].twists[0], speeds[pair.sample].step});
      pairs.motions.push_back(motions[pair.sample]);
      pairs.rows.push_back(pair.sample);
    }
    pairs.observations.push_back(trajectory.observations.samples);
    pairs.fates += trajectory.fates;
    pairs.identity_commands += trajectory.identity_commands;
  }
  return pairs;
}

void followPlayWithoutOutliers(TrainingPairs& pairs, const std::vector<Fate>& fates,
                               const MotionOptions& options) {
  if (!hasPlay(options)) return;
  std::vector<std::vector<bool>> out(pairs.observations.size());
  for (std::size_t k = 0; k < out.size(); ++k) out[k].resize(pairs.observations[k].size(), false);
  for (std::size_t i = 0; i < fates.size(); ++i)
    if (fates[i] == Fate::kSpeed || fates[i] == Fate::kAngularSpeed ||
        fates[i] == Fate::kLeastMedian)
      out[pairs.samples[i].trajectory][pairs.rows[i]] = true;
  MotionEstimator estimator(options);
  std::size_t next = 0;  // pairs are by trajectory, then by row
  for (std::size_t k = 0; k < out.size(); ++k) {
    PoseStream believed;
    std::vector<std::size_t> place(out[k].size(), 0);
    for (std::size_t row = 0; row < out[k].size(); ++row) {
      place[row] = believed.size();
      if (!out[k][row]) believed.push_back(pairs.observations[k][row]);
    }
    const std::vector<Motion> motions = motionsOf(believed, options, estimator);
    for (; next < fates.size() && pairs.samples[next].trajectory == k; ++next) {
      const std::size_t row = pairs.rows[next];
      if (out[k][row]) continue;
      pairs.motions[next].play = motions[place[row]].play;
      pairs.motions[next].joint_play = motions[place[row]].joint_play;
    }
  }
}

TrainingResult train(const Dataset& dataset, const TrainingConfig& config, double now,
                     const Progress& progress) {
  const auto report = [&](const char* phase, double fraction) {
    if (progress) progress(phase, fraction);
  };
  TrainingResult result;
  Correction& model = result.model;
  report("synchronising", 0.0);
  model.delay = resolveDelay(dataset, config, result.delay);
  model.speed_delay = speedDelayOf(dataset, config);
  if (config.simulation) result.simulation = config.simulation->name;
  if (config.simulation) model.physics = physicsOf(*config.simulation, dataset, model.delay);
  TrainingPairs pairs = makePairs(dataset, config, model.delay);
  result.fates = pairs.fates;
  result.identity_commands = pairs.identity_commands;

  report("cleaning", 0.1);
  std::vector<Fate> fates(pairs.samples.size(), Fate::kKept);
  if (config.cleaning_enabled) {
    const CleaningResult cleaned = clean(pairs.samples, config.cleaning);
    fates = cleaned.fates;
    result.least_median_scale = cleaned.least_median_scale;
    result.fates[Fate::kKept] = 0;
    result.fates += cleaned.counts;
    followPlayWithoutOutliers(pairs, fates, config.motion);
  }

  for (std::size_t i = 0; i < pairs.samples.size(); ++i)
    result.samples.push_back({pairs.samples[i].observation.p, fates[i]});

  RigidFitProblem rigid;
  rigid.rotation_length = config.rotation_length;
  const std::vector<std::size_t> kept = learntFrom(pairs, fates, config);
  std::set<std::size_t> trajectories;
  Hash hash;
  for (const std::size_t i : kept) {
    trajectories.insert(pairs.samples[i].trajectory);
    rigid.from.push_back(pairs.samples[i].observation);
    rigid.to.push_back(pairs.samples[i].command);
    hash.add(pairs.samples[i].observation);
    hash.add(pairs.samples[i].command);
  }
  if (kept.empty())
    throw InvalidInput(format(
        "%s: nothing left to learn from: of %zu observations in %zu trajectories %s, and %zu "
        "identity commands were removed; check that commands and observations overlap in time, "
        "that both are in the frame \"%s\" and in metres, and the limits under `cleaning`",
        dataset.source.c_str(), result.fates.total(), dataset.trajectories.size(),
        describe(result.fates).c_str(), result.identity_commands, dataset.frame.c_str()));
  const RigidFitResult fit = fitRigid(rigid);
  model.rigid = fit.X_b_a;
  result.rigid_rms_position = fit.rms_position;
  result.rigid_rms_angle = fit.rms_angle;

  std::vector<Eigen::Quaterniond> orientations;
  model.trust.workspace_min = model.trust.workspace_max = rigid.from.front().p;
  for (const Pose& pose : rigid.from) {
    orientations.push_back(model.rigid.q * pose.q);
    model.trust.workspace_min = model.trust.workspace_min.cwiseMin(pose.p);
    model.trust.workspace_max = model.trust.workspace_max.cwiseMax(pose.p);
  }
  model.mean_orientation = meanRotation(orientations);
  model.trust.workspace_margin = config.workspace_margin;
  model.trust.fade_start = config.fade_start;
  model.trust.fade_end = config.fade_end;
  model.motion = config.motion;

  const auto means = meansOf(pairs, kept, config, model, result);
  if (config.process_enabled) {
    report("fitting", 0.2);
    const auto features = static_cast<Eigen::Index>(featureCount(config.motion));
    const auto rows = static_cast<Eigen::Index>(kept.size() - result.out_of_reach);
    Eigen::MatrixXd x(rows, features);
    Eigen::MatrixXd y(rows, 6);
    Eigen::VectorXd row(features);
    std::vector<int> groups;  // a motion is seen or left out whole
    Eigen::Index r = 0;
    for (std::size_t k = 0; k < kept.size(); ++k) {
      if (!means[k]) continue;
      computeFeatures(pairs.motions[kept[k]], model.rigid, model.mean_orientation, config.motion,
                      row.data());
      x.row(r) = row.transpose();
      groups.push_back(static_cast<int>(pairs.samples[kept[k]].trajectory));
      y.row(r) = correctionBetween(*means[k], rigid.to[k]).transpose();
      ++r;
    }
    GpConfig process_config = config.process;
    if (config.tie_vectors)
      for (int j = 0; j < static_cast<int>(features); ++j)
        process_config.feature_blocks.push_back(j / 3);
    GpFit process = fitGp(x, y, process_config, groups,
                          [&](double fraction) { report("fitting", 0.2 + 0.8 * fraction); });
    model.process = std::move(process.model);
    result.process = std::move(process.report);
  }
  report("fitting", 1.0);

  model.version = RAVEN_CORRECTION_VERSION;
  model.trained_at = now;
  model.frame = dataset.frame;
  model.arm = dataset.arm;
  model.inputs = {dataset.source};
  model.input_hash = hash.text();
  model.id = makeId(now, model.input_hash);
  model.configuration = config.text;
  model.training_pairs = kept.size() - result.out_of_reach;
  model.training_trajectories = trajectories.size();
  return result;
}

}  // namespace raven_correction
