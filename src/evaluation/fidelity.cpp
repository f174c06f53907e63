// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/evaluation/fidelity.h"

#include <algorithm>
#include <limits>

#include "raven_correction/error.h"
#include "raven_correction/evaluation/table_one.h"
#include "raven_correction/geometry/statistics.h"
#include "raven_correction/robot/inverse_kinematics.h"
#include "raven_correction/simulation/session.h"

namespace raven_correction {
namespace {

constexpr double kDegree = 57.295779513082321;
constexpr double kMillimetre = 1e3;
constexpr int kBins = 4;  // of a joint and of speed: quartiles of the measured session
constexpr double kConfidence = 0.95;

/// One session as the figures see it.
struct Session {
  const Dataset& all;
  Dataset test;
  SessionStatistics statistics;
};

Session makeSession(const Dataset& all, const HoldOut& hold_out) {
  Session session{all, selectFold(all, hold_out, true), {}};
  session.statistics = sessionStatistics(session.test);
  return session;
}

// --- cleaning and timing ------------------------------------------------------------------------

FateCounts fatesOf(const Session& session, const TrainingConfig& config) {
  return train(session.test, configOf(Method::kRigidClean, config), 0.0).fates;
}

/// The rules of cleaning; the fates before them say what could not be paired at all.
bool isCleaningRule(Fate fate) { return fate >= Fate::kLongStep; }

/// Share of all observations that the rules of cleaning reject (or, not `by_rules`, that have no
/// pair to begin with). [%]
double rejectedShare(const FateCounts& fates, bool by_rules) {
  double rejected = 0.0;
  for (std::size_t i = 0; i < fates.count.size(); ++i)
    if (static_cast<Fate>(i) != Fate::kKept && isCleaningRule(static_cast<Fate>(i)) == by_rules)
      rejected += static_cast<double>(fates.count[i]);
  return 100.0 * rejected / static_cast<double>(fates.total());
}

void addCleaning(const FateCounts& measured, const FateCounts& simulated,
                 std::vector<StatisticsRow>& rows) {
  rows.push_back({"rejected by the rules of cleaning", rejectedShare(measured, true),
                  rejectedShare(simulated, true), "%"});
  rows.push_back({"repeated or without command", rejectedShare(measured, false),
                  rejectedShare(simulated, false), "%"});
  for (std::size_t i = 0; i < measured.count.size(); ++i) {
    const auto fate = static_cast<Fate>(i);
    if (fate == Fate::kKept) continue;
    const auto share = [fate](const FateCounts& fates) {
      return 100.0 * static_cast<double>(fates[fate]) / static_cast<double>(fates.total());
    };
    rows.push_back(
        {std::string("rejected: ") + fateName(fate), share(measured), share(simulated), "%"});
  }
}

void addIntervals(const Session& measured, const Session& simulated,
                  std::vector<StatisticsRow>& rows) {
  const std::vector<double> a = observationIntervals(measured.test);
  const std::vector<double> b = observationIntervals(simulated.test);
  for (const double q : {0.1, 0.5, 0.9, 0.99, 0.999})
    rows.push_back(
        {format("observation interval, quantile %g", q), quantile(a, q), quantile(b, q), "s"});
  rows.push_back({"observation interval, longest", quantile(a, 1.0), quantile(b, 1.0), "s"});
}

// --- errors against joints and speed
// --------------------------------------------------------------

struct Samples {
  std::vector<std::vector<double>> keys;  ///< one list per joint, then speed
  std::vector<double> position, angle;
};

Samples samplesOf(const Session& session, const KinematicChain& robot) {
  const InverseKinematics ik(robot);
  Samples samples;
  samples.keys.resize(static_cast<std::size_t>(robot.size()) + 1);
  JointVector seed = robot.home();
  for (const PairResidual& residual : pairResiduals(session.test, session.statistics.delay)) {
    const IkResult result = ik.solve(residual.command, seed);
    if (!reproducesPose(result.status)) continue;
    seed = result.joints;
    for (int j = 0; j < robot.size(); ++j)
      samples.keys[static_cast<std::size_t>(j)].push_back(result.joints(j));
    samples.keys.back().push_back(residual.speed);
    samples.position.push_back(residual.position);
    samples.angle.push_back(residual.angle);
  }
  return samples;
}

/// Median of the values whose key lies in [lower, upper); NaN where there is none.
double medianWithin(const std::vector<double>& keys, const std::vector<double>& values,
                    double lower, double upper) {
  std::vector<double> chosen;
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (keys[i] >= lower && keys[i] < upper) chosen.push_back(values[i]);
  return chosen.empty() ? std::numeric_limits<double>::quiet_NaN() : median(chosen);
}

void addDependence(const Session& measured, const Session& simulated, const KinematicChain& robot,
                   std::vector<StatisticsRow>& rows) {
  const Samples a = samplesOf(measured, robot);
  const Samples b = samplesOf(simulated, robot);
  for (std::size_t k = 0; k < a.keys.size(); ++k) {
    const bool is_speed = k + 1 == a.keys.size();
    const std::string name = is_speed ? "speed" : robot.joints()[k].name;
    const bool is_length = is_speed || robot.joints()[k].type == JointType::kPrismatic;
    const char* const unit = is_speed ? "mm/s" : is_length ? "mm" : "deg";
    const double scale = is_length ? kMillimetre : kDegree;
    for (int bin = 0; bin < kBins; ++bin) {
      const double lower = quantile(a.keys[k], static_cast<double>(bin) / kBins);
      double upper = quantile(a.keys[k], static_cast<double>(bin + 1) / kBins);
      if (bin + 1 == kBins) upper = std::nextafter(upper, 1e9);
      if (!(upper > lower)) continue;
      const std::string where =
          format("%s %.1f to %.1f %s", name.c_str(), scale * lower, scale * upper, unit);
      rows.push_back({"position error, " + where,
                      kMillimetre * medianWithin(a.keys[k], a.position, lower, upper),
                      kMillimetre * medianWithin(b.keys[k], b.position, lower, upper), "mm"});
      rows.push_back({"orientation error, " + where,
                      kDegree * medianWithin(a.keys[k], a.angle, lower, upper),
                      kDegree * medianWithin(b.keys[k], b.angle, lower, upper), "deg"});
    }
  }
}

// --- the ladder
// -----------------------------------------------------------------------------------

/// Sums over the test states of one trajectory.
struct TrajectorySum {
  Eigen::Matrix<double, 6, 1> sum_abs = Eigen::Matrix<double, 6, 1>::Zero();
  double n = 0.0;
};
using MethodSums = std::vector<TrajectorySum>;  // one per trajectory of the test set

/// Norms of the mean absolute errors over the trajectories that are drawn: position, angle.
Eigen::Vector2d norms(const MethodSums& sums, const std::vector<std::size_t>& drawn) {
  TrajectorySum total;
  for (const std::size_t i : drawn) {
    total.sum_abs += sums[i].sum_abs;
    total.n += sums[i].n;
  }
  if (!(total.n > 0.0)) return Eigen::Vector2d::Zero();
  const Eigen::Matrix<double, 6, 1> mean = total.sum_abs / total.n;
  return {mean.head<3>().norm(), mean.tail<3>().norm()};
}

/// Per method, in the order of the table: its sums, and its norms under every resample.
struct Ladder {
  std::vector<MethodSums> sums;
  std::vector<std::vector<Eigen::Vector2d>> resampled;
};

Ladder climb(const Session& session, const FidelityProblem& problem, const Progress& progress) {
  Ladder ladder;
  ladder.sums.resize(static_cast<std::size_t>(Method::kCount),
                     MethodSums(session.test.trajectories.size()));
  TableOneProblem table;
  table.configurations = {{problem.training.name, problem.training}};
  table.observer = [&](const TableOneRow& row, const std::vector<TestState>& states,
                       const std::vector<PoseError>& errors) {
    if (!row.clean) return;
    MethodSums& sums = ladder.sums[static_cast<std::size_t>(row.method)];
    for (std::size_t i = 0; i < states.size(); ++i) {
      sums[states[i].trajectory].sum_abs += errors[i].components.cwiseAbs();
      sums[states[i].trajectory].n += 1.0;
    }
  };
  evaluateOn(selectFold(session.all, problem.hold_out, false), session.test, table, progress);
  ladder.resampled.resize(ladder.sums.size());
  bootstrapOverGroups(session.test.trajectories.size(), problem.resamples, problem.seed,
                      [&](const std::vector<std::size_t>& drawn) {
                        for (std::size_t m = 0; m < ladder.sums.size(); ++m)
                          ladder.resampled[m].push_back(norms(ladder.sums[m], drawn));
                      });
  return ladder;
}

LadderValue valueOf(const Ladder& ladder, std::size_t method, int component) {
  std::vector<std::size_t> all(ladder.sums[method].size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  std::vector<double> resampled;
  for (const Eigen::Vector2d& value : ladder.resampled[method])
    resampled.push_back(value(component));
  return {norms(ladder.sums[method], all)(component),
          quantile(resampled, 0.5 * (1.0 - kConfidence)),
          quantile(resampled, 0.5 * (1.0 + kConfidence))};
}

/// When two methods count as different: their intervals do not overlap; or, which is stricter, the
/// interval of their difference on the same resamples does not hold 0.
enum class Tie { kIntervals, kPaired };

/// -1: a is surely the smaller, +1: b is, 0: a tie.
int order(const Ladder& ladder, std::size_t a, std::size_t b, int component, Tie tie) {
  if (tie == Tie::kIntervals) {
    const LadderValue first = valueOf(ladder, a, component);
    const LadderValue second = valueOf(ladder, b, component);
    return first.upper < second.lower ? -1 : first.lower > second.upper ? 1 : 0;
  }
  std::vector<double> differences;
  for (std::size_t k = 0; k < ladder.resampled[a].size(); ++k)
    differences.push_back(ladder.resampled[a][k](component) - ladder.resampled[b][k](component));
  if (quantile(differences, 0.5 * (1.0 + kConfidence)) < 0.0) return -1;
  return quantile(differences, 0.5 * (1.0 - kConfidence)) > 0.0 ? 1 : 0;
}

/// Pairs of methods that both sessions tell apart, and rank in opposite order.
double contradictions(const Ladder& measured, const Ladder& simulated, int component, Tie tie) {
  double count = 0.0;
  for (std::size_t a = 0; a < measured.sums.size(); ++a)
    for (std::size_t b = a + 1; b < measured.sums.size(); ++b)
      if (order(measured, a, b, component, tie) * order(simulated, a, b, component, tie) < 0)
        count += 1.0;
  return count;
}

void addLadder(const Ladder& measured, const Ladder& simulated, FidelityResult& result) {
  for (std::size_t m = 0; m < measured.sums.size(); ++m) {
    LadderStep step;
    step.method = methodName(static_cast<Method>(m));
    step.measured_position = valueOf(measured, m, 0);
    step.simulated_position = valueOf(simulated, m, 0);
    step.measured_angle = valueOf(measured, m, 1);
    step.simulated_angle = valueOf(simulated, m, 1);
    result.rows.push_back({"Table I, position, " + step.method,
                           kMillimetre * step.measured_position.value,
                           kMillimetre * step.simulated_position.value, "mm"});
    result.rows.push_back({"Table I, orientation, " + step.method,
                           kDegree * step.measured_angle.value,
                           kDegree * step.simulated_angle.value, "deg"});
    result.ladder.push_back(step);
  }
  for (const int component : {0, 1})
    result.rows.push_back({std::string("pairs of methods ranked the other way, paired, ") +
                               (component == 0 ? "position" : "orientation"),
                           0.0, contradictions(measured, simulated, component, Tie::kPaired),
                           "pairs"});
}

double ratio(double simulated, double measured) {
  return measured > 0.0 ? simulated / measured - 1.0 : 0.0;
}

}  // namespace

FidelityResult compareFidelity(const Dataset& measured, const FidelityProblem& problem,
                               const Progress& progress) {
  const auto tell = [&progress](const char* phase, double fraction) {
    if (progress) progress(phase, fraction);
  };
  tell("simulating", 0.0);
  const Dataset simulated = simulateCommands(problem.simulation, measured, problem.seed);
  const Session a = makeSession(measured, problem.hold_out);
  const Session b = makeSession(simulated, problem.hold_out);
  if (a.test.trajectories.empty())
    throw InvalidInput(format("%s: none of %zu trajectories is held out, at least %d are needed",
                              measured.source.c_str(), measured.trajectories.size(),
                              problem.hold_out.folds));
  FidelityResult result;
  result.trajectories = a.test.trajectories.size();
  result.hold_out = problem.hold_out;
  result.overlap = overlapOf(problem.simulation, a.test);
  result.rows = compareStatistics(a.statistics, b.statistics);
  const FateCounts measured_fates = fatesOf(a, problem.training);
  const FateCounts simulated_fates = fatesOf(b, problem.training);
  addCleaning(measured_fates, simulated_fates, result.rows);
  addIntervals(a, b, result.rows);
  addDependence(a, b, problem.simulation.robot, result.rows);
  const auto part = [&](const char* phase, double begin) {
    return [&tell, phase, begin](const std::string&, double fraction) {
      tell(phase, begin + 0.45 * fraction);
    };
  };
  const Ladder measured_ladder = climb(a, problem, part("Table I on the measured session", 0.1));
  const Ladder simulated_ladder = climb(b, problem, part("Table I on the simulated session", 0.55));
  addLadder(measured_ladder, simulated_ladder, result);

  const SessionStatistics& m = a.statistics;
  const SessionStatistics& s = b.statistics;
  result.criteria = {
      {"position after rigid fit, median", ratio(s.rigid_position_median, m.rigid_position_median),
       0.15, "ratio"},
      {"position after rigid fit, p95", ratio(s.rigid_position_p95, m.rigid_position_p95), 0.15,
       "ratio"},
      {"orientation after fixed rotations, median", ratio(s.angle_median, m.angle_median), 0.2,
       "ratio"},
      {"delay", s.delay - m.delay, 0.02, "s"},
      {"rejected by the rules of cleaning",
       rejectedShare(simulated_fates, true) - rejectedShare(measured_fates, true), 2.0, "%"},
      {"pairs of methods ranked the other way, position",
       contradictions(measured_ladder, simulated_ladder, 0, Tie::kIntervals), 0.0, "pairs"},
      {"pairs of methods ranked the other way, orientation",
       contradictions(measured_ladder, simulated_ladder, 1, Tie::kIntervals), 0.0, "pairs"}};
  tell("done", 1.0);
  return result;
}

}  // namespace raven_correction
