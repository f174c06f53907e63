// SPDX-License-Identifier: BSD-3-Clause
// Debridement by a fake arm whose tool errs by a known offset: what is picked up, tried again,
// given up, replanned, and what two arms leave to one another.
#include "raven_correction/simulation/debridement_task.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "raven_correction/error.h"
#include "raven_correction/simulation/debridement_field.h"

namespace raven_correction {
namespace {

FragmentSighting sightingAt(double x, double y) {
  FragmentSighting fragment;
  fragment.p_field = {x, y, 0.002};
  return fragment;
}

/// Fragments are points that a jaw within 2 mm takes; the tool is off by `error`.
class FakeCell : public DebridementCell {
 public:
  double now() override { return time; }
  void move(const char* kind, const Pose& X_base_tool, double dwell) override {
    kinds.emplace_back(kind);
    tool = {X_base_tool.p + error, X_base_tool.q};
    error = Eigen::Vector3d::Zero() + lasting_error;
    time += 1.0 + dwell;
  }
  void setJaw(double opening, double dwell) override {
    time += dwell;
    if (opening < 0.2 && jaw >= 0.2) {
      ++closed;
      for (std::size_t i = 0; i < fragments.size(); ++i)
        if ((fragments[i].p_field - tool.p).norm() < 0.002) {
          fragments.erase(fragments.begin() + static_cast<std::ptrdiff_t>(i));
          holding = true;
          break;
        }
    } else if (opening >= 0.2 && jaw < 0.2 && holding) {
      holding = false;
      released.push_back(tool.p);
    }
    jaw = opening;
  }
  FieldPicture look() override {
    ++looks;
    return {time, fragments};
  }
  void wait(double duration) override { time += duration; }
  double predictedDeviation() override { return predicted; }
  bool replanHere() override {
    ++replans;
    tool.p -= lasting_error;
    return true;
  }

  std::vector<FragmentSighting> fragments;
  Eigen::Vector3d error = Eigen::Vector3d::Zero();          // of the next motion
  Eigen::Vector3d lasting_error = Eigen::Vector3d::Zero();  // of all after it
  double predicted = 0.0;
  Pose tool;
  double time = 0.0, jaw = 0.0;
  bool holding = false;
  int looks = 0, closed = 0, replans = 0;
  std::vector<Eigen::Vector3d> released;
  std::vector<std::string> kinds;
};

DebridementTaskConfig config() {
  DebridementTaskConfig config;
  config.X_base_rest.p = {0.0, 0.05, 0.07};
  config.X_base_rest.q = config.orientation.normalized();
  config.retry_shift = 0.001;  // less than the jaw of the fake cell forgives
  return config;
}

TEST(DebridementTask, CarriesEveryFragmentToTheReceptacle) {
  FakeCell cell;
  cell.fragments = {sightingAt(0.0, 0.0), sightingAt(0.02, 0.01), sightingAt(-0.03, -0.02)};
  FragmentBook book({}, {FieldPart{}});
  DebridementTask task(config(), 0, cell, book);
  const std::vector<FragmentRecord> records = task.run();
  ASSERT_EQ(records.size(), 3u);
  EXPECT_TRUE(cell.fragments.empty());
  ASSERT_EQ(cell.released.size(), 3u);
  for (const Eigen::Vector3d& p : cell.released)
    EXPECT_LT((p - config().X_base_rest.p).norm(), 1e-9);
  for (const FragmentRecord& record : records) {
    EXPECT_TRUE(record.picked);
    EXPECT_EQ(record.attempts, 1u);
    EXPECT_GT(record.end, record.begin);
  }
  EXPECT_EQ(cell.closed, 3);
  EXPECT_EQ(cell.looks, 4);  // one before the work, one after each grasp
  EXPECT_EQ(cell.kinds.back(), "move_holding");
}

TEST(DebridementTask, TriesAgainAndGivesUpInTheEnd) {
  FakeCell cell;
  cell.fragments = {sightingAt(0.0, 0.0)};
  cell.lasting_error = {0.005, 0.0, 0.0};
  FragmentBookConfig rules;
  rules.attempts = 3;
  FragmentBook book(rules, {FieldPart{}});
  DebridementTask task(config(), 0, cell, book);
  const std::vector<FragmentRecord> records = task.run();
  ASSERT_EQ(records.size(), 1u);
  EXPECT_FALSE(records[0].picked);
  EXPECT_EQ(records[0].attempts, 3u);
  EXPECT_EQ(book.givenUp(), 1u);
  EXPECT_TRUE(cell.released.empty());
  EXPECT_EQ(cell.kinds.back(), "move_empty");
}

TEST(DebridementTask, OneFailureCostsOneRetry) {
  FakeCell cell;
  cell.fragments = {sightingAt(0.0, 0.0)};
  FragmentBook book({}, {FieldPart{}});
  DebridementTask task(config(), 0, cell, book);
  // The first motion goes to the receptacle, the second over the fragment, the third to it.
  struct OnceWrong : FakeCell {
    void move(const char* kind, const Pose& X, double dwell) override {
      FakeCell::move(kind, X, dwell);
      if (std::string(kind) == "grasp" && !wrong) tool.p.x() += 0.004, wrong = true;
    }
    bool wrong = false;
  } arm;
  arm.fragments = cell.fragments;
  const std::vector<FragmentRecord> records = DebridementTask(config(), 0, arm, book).run();
  ASSERT_EQ(records.size(), 1u);
  EXPECT_TRUE(records[0].picked);
  EXPECT_EQ(records[0].attempts, 2u);
  EXPECT_EQ(arm.released.size(), 1u);
}

// The jaw takes what lies beside the fragment: that is carried away, and the fragment tried again.
TEST(DebridementTask, CarriesAwayANeighbourThatItTookInstead) {
  struct Sideways : FakeCell {
    void move(const char* kind, const Pose& X, double dwell) override {
      FakeCell::move(kind, X, dwell);
      if (std::string(kind) == "grasp" && !wrong) tool.p.x() += 0.008, wrong = true;
    }
    bool wrong = false;
  } arm;
  arm.fragments = {sightingAt(0.0, 0.0), sightingAt(0.008, 0.0)};
  DebridementTaskConfig task = config();
  task.X_base_rest.p = {-0.05, 0.0, 0.07};  // so that the one on the left is the first
  FragmentBook book({}, {{-1.0, 1.0, task.X_base_rest.p}});
  const std::vector<FragmentRecord> records = DebridementTask(task, 0, arm, book).run();
  EXPECT_TRUE(arm.fragments.empty());
  ASSERT_EQ(arm.released.size(), 2u);
  for (const Eigen::Vector3d& p : arm.released) EXPECT_LT((p - task.X_base_rest.p).norm(), 1e-9);
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].attempts, 2u);
}

TEST(DebridementTask, ReplansWhereALargeDeviationIsPredictedAndAfterAMiss) {
  for (const bool sure : {true, false}) {
    FakeCell cell;
    cell.fragments = {sightingAt(0.0, 0.0)};
    cell.lasting_error = {0.005, 0.0, 0.0};
    cell.predicted = sure ? 0.001 : 0.003;
    DebridementTaskConfig limited = config();
    limited.deviation_limit = 0.002;
    FragmentBook book({}, {FieldPart{}});
    const std::vector<FragmentRecord> records = DebridementTask(limited, 0, cell, book).run();
    ASSERT_EQ(records.size(), 1u);
    EXPECT_TRUE(records[0].picked);
    EXPECT_EQ(records[0].attempts, sure ? 2u : 1u);
    EXPECT_EQ(cell.replans, 1);
    EXPECT_EQ(records[0].replans, 1u);
    EXPECT_DOUBLE_EQ(records[0].predicted, cell.predicted);
  }
}

TEST(DebridementTask, ClosesAcrossTheLongAxisAsFarAsTheLimitAllows) {
  FakeCell cell;
  FragmentBook book({}, {FieldPart{}});
  const DebridementTask task(config(), 0, cell, book);
  const auto across = [&](double yaw, double length) {
    FragmentSighting fragment = sightingAt(0.01, 0.02);
    fragment.yaw = yaw;
    fragment.length = length;
    const Pose X = task.graspPose(fragment);
    EXPECT_LT((X.p - fragment.p_field).norm(), 1e-12);
    const Eigen::Vector3d down = X.q * Eigen::Vector3d::UnitX();
    EXPECT_LT(down.z(), -0.98);
    const Eigen::Vector3d y = X.q * Eigen::Vector3d::UnitY();
    return std::remainder(std::atan2(y.y(), y.x()) - yaw, M_PI);
  };
  const Eigen::Vector3d y = config().orientation.normalized() * Eigen::Vector3d::UnitY();
  const double straight = std::atan2(y.y(), y.x()) + M_PI_2;  // yaw that needs no turn
  for (const double turn : {-0.6, 0.0, 0.3, 0.69})
    EXPECT_NEAR(std::abs(across(straight + turn, 0.010)), M_PI_2, 1e-9) << turn;
  EXPECT_NEAR(std::abs(across(straight + 0.9, 0.010)), M_PI_2 - 0.2, 1e-9);
  EXPECT_NEAR(std::abs(across(straight - 0.9, 0.010)), M_PI_2 - 0.2, 1e-9);
  // After a miss it comes turned otherwise.
  FragmentSighting fragment = sightingAt(0.01, 0.02);
  fragment.yaw = straight;
  const auto turnOf = [&](unsigned failed) {
    const Eigen::AngleAxisd turn(task.graspPose(fragment, failed).q *
                                 task.graspPose(fragment).q.conjugate());
    return turn.angle() * turn.axis().z();
  };
  EXPECT_NEAR(std::abs(turnOf(1)), config().retry_turn, 1e-9);
  EXPECT_NEAR(turnOf(2), -turnOf(1), 1e-9);
  EXPECT_NEAR(turnOf(3), 0.0, 1e-9);
  // At the limit only inwards, on either side.
  for (const double yaw : {straight + 0.9, straight - 0.9}) {
    FragmentSighting turned = sightingAt(0.01, 0.02);
    turned.yaw = yaw;
    turned.length = 0.010;
    for (unsigned failed = 0; failed < 4; ++failed) {
      const Eigen::AngleAxisd turn(task.graspPose(turned, failed).q *
                                   config().orientation.normalized().conjugate());
      EXPECT_LE(turn.angle(), config().turn_limit + 1e-9) << failed;
    }
    const Eigen::AngleAxisd inwards(task.graspPose(turned, 1).q *
                                    task.graspPose(turned).q.conjugate());
    EXPECT_NEAR(inwards.angle(), config().retry_turn, 1e-9);
  }
  const auto shiftOf = [&](unsigned failed) {
    const Pose there = task.graspPose(fragment, failed);
    return Eigen::Vector3d(there.q.conjugate() * (there.p - task.graspPose(fragment).p));
  };
  // To the side, across the jaw; its own turn has moved the axis.
  EXPECT_NEAR(std::abs(shiftOf(1).y()), config().retry_shift, 1e-12);
  EXPECT_NEAR((shiftOf(1) + shiftOf(2)).norm(), 0.0, 1e-12);
  EXPECT_EQ(shiftOf(3), Eigen::Vector3d(0.0, 0.0, 0.0));
  // Nearly round: there is nothing to turn to.
  EXPECT_NEAR(std::abs(across(straight + 0.3, 0.0062)), M_PI_2 - 0.3, 1e-9);
}

TEST(DebridementTask, RehearsesInsideItsBox) {
  FakeCell cell;
  RehearsalConfig rehearsal;
  rehearsal.fragments = 20;
  rehearsal.turn = 0.5;
  struct Places : FakeCell {
    void move(const char* kind, const Pose& X, double dwell) override {
      FakeCell::move(kind, X, dwell);
      if (std::string(kind) == "grasp") places.push_back(X.p);
    }
    std::vector<Eigen::Vector3d> places;
  } arm;
  unsigned done = 0;
  rehearse(
      config(), rehearsal, [](const Pose& X) { return X.p.x() > 0.0; }, arm,
      [&](unsigned n) { done = n; });
  EXPECT_EQ(done, 20u);
  ASSERT_EQ(arm.places.size(), 20u);
  for (const Eigen::Vector3d& p : arm.places) {
    EXPECT_GT(p.x(), 0.0);
    EXPECT_TRUE(((p - rehearsal.centre).cwiseAbs().array() <= rehearsal.half_size.array()).all());
  }
  EXPECT_THROW(rehearse(config(), rehearsal, [](const Pose&) { return false; }, arm, {}),
               InvalidInput);
}

TEST(FragmentBook, ArmsKeepToTheirPartsAndApart) {
  FragmentBookConfig rules;
  rules.separation = 0.03;
  FragmentBook book(rules, {{0.0, 1.0, {0.05, 0.0, 0.0}}, {-1.0, 0.0, {-0.05, 0.0, 0.0}}});
  FragmentSighting left = sightingAt(0.005, 0.0), near = sightingAt(-0.010, 0.0);
  book.see({1.0, {left, near}});
  using Next = FragmentBook::Next;
  const auto first = book.choose(0);
  ASSERT_EQ(first.next, Next::kWork);
  EXPECT_EQ(first.fragment.p_field, left.p_field);
  EXPECT_EQ(book.choose(1).next, Next::kWait);
  // One that is far enough comes first.
  const FragmentSighting far = sightingAt(-0.010, 0.035);
  book.see({2.0, {left, near, far}});
  const auto second = book.choose(1);
  ASSERT_EQ(second.next, Next::kWork);
  EXPECT_EQ(second.fragment.p_field, far.p_field);
  // An older picture does not bring back what is gone.
  book.see({3.0, {near}});
  book.see({2.5, {left, near, far}});
  // The other arm still works, and may drop something here.
  EXPECT_EQ(book.choose(0).next, Next::kIdle);
  book.leave(1);
  EXPECT_EQ(book.choose(0).next, Next::kNothing);
  book.leave(0);
  EXPECT_EQ(book.choose(1).fragment.p_field, near.p_field);
}

TEST(FragmentBook, UncoveredFragmentsComeFirst) {
  FragmentBook book({}, {FieldPart{}});
  FragmentSighting hidden = sightingAt(0.0, 0.0), free = sightingAt(0.03, 0.0);
  hidden.partly_hidden = true;
  book.see({1.0, {hidden, free}});
  EXPECT_EQ(book.choose(0).fragment.p_field, free.p_field);
  EXPECT_FALSE(book.failed(0));
  // Tried in vain: still before a covered one.
  EXPECT_EQ(book.choose(0).tried, 1u);
  EXPECT_THROW(FragmentBook({}, {}), InvalidInput);
}

TEST(Grasp, HoldsWithinItsToleranceAndNotBeyond) {
  const GraspConfig grasp;
  FragmentTruth fragment;
  fragment.p_field = {0.01, 0.0, 0.002};
  fragment.yaw = 0.0;
  fragment.length = 0.010;
  fragment.width = 0.006;
  // x down, y along y of the field: across the long axis.
  Eigen::Matrix3d R;
  R << 0, 0, -1, 0, 1, 0, -1, 0, 0;
  R.col(2) = R.col(0).cross(R.col(1));
  Pose X{fragment.p_field, Eigen::Quaterniond(R)};
  const double opening = 1.4, room = 2 * 0.010 * std::sin(0.7) + 0.001;
  EXPECT_TRUE(fitGrasp(grasp, fragment, X, opening).holds);
  EXPECT_NEAR(fitGrasp(grasp, fragment, X, opening).extent, 0.006, 1e-12);
  const auto shifted = [&](const Eigen::Vector3d& d) {
    return fitGrasp(grasp, fragment, {X.p + d, X.q}, opening).holds;
  };
  const double across = 0.5 * (room - 0.006);
  EXPECT_TRUE(shifted({0.0, across - 1e-5, 0.0}));
  EXPECT_FALSE(shifted({0.0, across + 1e-5, 0.0}));
  EXPECT_TRUE(shifted({0.0, 0.0, grasp.height - 1e-5}));
  EXPECT_FALSE(shifted({0.0, 0.0, grasp.height + 1e-5}));
  EXPECT_TRUE(shifted({grasp.along_pads - 1e-5, 0.0, 0.0}));
  EXPECT_FALSE(shifted({grasp.along_pads + 1e-5, 0.0, 0.0}));
  const auto tilted = [&](double angle) {
    return fitGrasp(grasp, fragment, {X.p, X.q * expRotation({0.0, angle, 0.0})}, opening).holds;
  };
  EXPECT_TRUE(tilted(grasp.tilt - 0.01));
  EXPECT_FALSE(tilted(grasp.tilt + 0.01));
  // Turned along its length it does not fit into a jaw that is hardly open.
  const Pose turned{X.p, expRotation({0.0, 0.0, M_PI_2}) * X.q};
  EXPECT_NEAR(fitGrasp(grasp, fragment, turned, opening).extent, 0.010, 1e-12);
  EXPECT_TRUE(fitGrasp(grasp, fragment, X, 0.7).holds);
  EXPECT_FALSE(fitGrasp(grasp, fragment, turned, 0.7).holds);
}

TEST(DebridementField, AFragmentIsTakenCarriedAndDelivered) {
  DebridementFieldConfig config;
  config.p_field_receptacle = {{0.0, 0.04, 0.065}};
  DebridementField field(config);
  DebridementSceneConfig scene;
  field.set(makeDebridementScene(scene, 3));
  const std::size_t before = field.scene().fragments.size();
  ASSERT_GT(before, 0u);
  const FragmentTruth target = measureFragment(field.scene().fragments.back());
  FakeCell cell;
  FragmentBook book({}, {FieldPart{}});
  DebridementTaskConfig task;
  task.turn_limit = 2.0;
  const Pose X = DebridementTask(task, 0, cell, book)
                     .graspPose({target.p_field, target.yaw, target.length, target.width, false});
  using Kind = JawOutcome::Kind;
  EXPECT_EQ(field.close("left", {X.p + Eigen::Vector3d(0.0, 0.0, 0.02), X.q}, 1.5).kind,
            Kind::kMissed);
  EXPECT_EQ(field.open("left", X).kind, Kind::kEmpty);
  const JawOutcome held = field.close("left", X, 1.5);
  ASSERT_EQ(held.kind, Kind::kHeld);
  EXPECT_EQ(held.fragment, static_cast<int>(before) - 1);
  EXPECT_EQ(field.scene().fragments.size(), before - 1);
  // Let go over the field: it lies there again, and can be taken from there.
  const Pose away{X.p - 0.5 * Eigen::Vector3d(X.p.x(), X.p.y(), 0.0), X.q};
  EXPECT_EQ(field.open("left", away).kind, Kind::kDropped);
  ASSERT_EQ(field.scene().fragments.size(), before);
  const FragmentTruth there = measureFragment(field.scene().fragments.back());
  EXPECT_LT((there.p_field - away.p).head<2>().norm(), 1e-4);
  Pose again = X;
  again.p = there.p_field;
  ASSERT_EQ(field.close("left", again, 1.5).kind, Kind::kHeld);
  EXPECT_EQ(field.open("left", {{0.0, 0.05, 0.065}, X.q}).kind, Kind::kDelivered);
  EXPECT_EQ(field.delivered(), 1);
  EXPECT_EQ(field.scene().fragments.size(), before - 1);
}

}  // namespace
}  // namespace raven_correction
