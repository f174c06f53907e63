// SPDX-License-Identifier: BSD-3-Clause
// The offline command line as a user calls it: exit codes, texts, and that nothing is overwritten.
#include "raven_correction/ros/offline.h"

#include <gtest/gtest.h>
#include <rosbag/bag.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "raven_correction/correction/training.h"
#include "raven_correction/dataset/csv.h"
#include "raven_correction/dataset/dataset_directory.h"
#include "raven_correction/evaluation/table_one.h"
#include "raven_correction/ros/conversions.h"
#include "raven_correction/ros/model_file.h"
#include "raven_correction/ros/session_bag.h"
#include "raven_correction/ros/topics.h"
#include "support/temporary_directory.h"
#include "support/test_data.h"

namespace raven_correction {
namespace {

namespace fs = std::filesystem;

struct Outcome {
  int code;
  std::string text;  // standard error
};

Outcome offline(std::vector<std::string> words) {
  words.insert(words.begin(), "offline");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  const int code = runOffline(static_cast<int>(argv.size()), argv.data());
  testing::internal::GetCapturedStdout();
  return {code, testing::internal::GetCapturedStderr()};
}

void expectRefused(const Outcome& outcome, const std::string& part) {
  EXPECT_EQ(outcome.code, 2) << outcome.text;
  EXPECT_NE(outcome.text.find(part), std::string::npos) << outcome.text;
}

constexpr char kQuickConfig[] =
    "process: {criterion: likelihood, length_scales: common, grouping: shared,\n"
    "          max_hyper_points: 80, max_exact_points: 150, backend: exact}\n";

class OfflineTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(offline({"simulate", "--simulation", "config/simulation/raven2_left_case2014.yaml",
                       "--trajectories", "10", "--seed", "3", "-o", session_})
                  .code,
              0);
    std::ofstream(config_) << kQuickConfig;
  }
  void expectAgreement(const std::string& session, const std::string& config, int fold);

  const TemporaryDirectory folder_;
  const std::string session_ = folder_.path() + "/session";
  const std::string config_ = folder_.path() + "/quick.yaml";
  const std::string model_ = folder_.path() + "/model.bag";
};

TEST_F(OfflineTest, ImportAndExportKeepEverySample) {
  const std::string bag = folder_.path() + "/session.bag", back = folder_.path() + "/back";
  EXPECT_EQ(offline({"import", session_, "-o", bag}).code, 0);
  EXPECT_EQ(offline({"export", bag, "-o", back}).code, 0);
  const Dataset a = readDatasetDirectory(session_), b = readDatasetDirectory(back);
  ASSERT_EQ(a.trajectories.size(), b.trajectories.size());
  for (std::size_t k = 0; k < a.trajectories.size(); ++k) {
    EXPECT_EQ(a.trajectories[k].id, b.trajectories[k].id);
    ASSERT_EQ(a.trajectories[k].commands.size(), b.trajectories[k].commands.size());
    ASSERT_EQ(a.trajectories[k].observations.size(), b.trajectories[k].observations.size());
    for (std::size_t i = 0; i < a.trajectories[k].observations.size(); ++i) {
      EXPECT_EQ(a.trajectories[k].observations[i].pose.p, b.trajectories[k].observations[i].pose.p);
      EXPECT_NEAR(a.trajectories[k].observations[i].stamp, b.trajectories[k].observations[i].stamp,
                  1e-8);
    }
  }
  expectRefused(offline({"import", session_, "-o", bag}), "exists");
  expectRefused(offline({"export", bag, "-o", back}), "not empty");
}

/// Trains without a fold, predicts its trajectories in a second run of the program, and compares
/// the errors of what that wrote with evaluate's row of the fold.
void OfflineTest::expectAgreement(const std::string& session, const std::string& config, int fold) {
  ASSERT_EQ(offline({"train", session, "-o", model_, "--config", config, "--hold-out",
                     std::to_string(fold) + "/5"})
                .code,
            0);
  const Dataset dataset = readDatasetDirectory(session);
  const Dataset left_out = selectFold(dataset, HoldOut{fold, 5}, true);
  const std::string test_set = folder_.path() + "/left_out";
  writeDatasetDirectory(left_out, test_set);
  const std::string out = folder_.path() + "/commands.csv";
  ASSERT_EQ(
      offline({"predict", "--model", model_, "--states", test_set + "/observations.csv", "-o", out})
          .code,
      0);

  // What predict wrote, against the command at the stamp that it names.
  std::ifstream file(out);
  std::string line, header;
  std::getline(file, header);
  EXPECT_EQ(header, "trajectory,stamp,x,y,z,qx,qy,qz,qw,sx,sy,sz,srx,sry,srz,status");
  TableOneProblem problem;
  problem.configurations = {{"best", loadTrainingConfig(config)}};
  const TableOneResult table = crossValidate(dataset, problem);
  const Correction model = readModelFile(model_);
  const std::vector<TestState> states = makeTestStates(
      left_out, model.motion, model.delay,
      commandGapLimit(selectFold(dataset, HoldOut{fold, 5}, false), SynchronisationOptions()), {});
  std::map<std::pair<std::size_t, std::size_t>, Pose> predicted;
  std::size_t trajectory = 0, row = 0;
  std::string last;
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    std::string id, value;
    std::getline(fields, id, ',');
    double v[8];
    for (double& number : v) {
      std::getline(fields, value, ',');
      number = std::stod(value);
    }
    if (!last.empty() && id != last) {
      ++trajectory;
      row = 0;
    }
    last = id;
    EXPECT_NEAR(v[0], left_out.trajectories[trajectory].observations[row].stamp - model.delay,
                1e-6);
    predicted[{trajectory, row++}] = {{v[1], v[2], v[3]}, {v[7], v[4], v[5], v[6]}};
  }
  if (!model.physics.empty()) {  // Table I has no method with physics: the model itself says
    const Predictor predictor(model);
    const auto workspace = predictor.makeWorkspace();
    for (const TestState& state : states) {
      const Pose expected = predictor.predict(state.motion, *workspace).command;
      const PoseError error = poseError(predicted.at({state.trajectory, state.row}), expected);
      ASSERT_LT(error.components.head<3>().norm(), 1e-9);
      ASSERT_LT(error.angle, 1e-7);
    }
    return;
  }
  const std::vector<bool> clean =
      cleanStates(states,
                  train(selectFold(dataset, HoldOut{fold, 5}, false),
                        configOf(Method::kRigidClean, loadTrainingConfig(config)), 0.0)
                      .model.rigid,
                  {});
  std::vector<PoseError> errors;
  for (std::size_t i = 0; i < states.size(); ++i)
    if (clean[i])
      errors.push_back(
          poseError(predicted.at({states[i].trajectory, states[i].row}), states[i].command));
  const ErrorSummary expected = table.row("best", Method::kRigidGpVelocityClean, true, fold).errors;
  const ErrorSummary measured = summarise(errors);
  EXPECT_EQ(measured.n, expected.n);
  EXPECT_NEAR(1e3 * measured.position_norm, 1e3 * expected.position_norm, 1e-6);
  EXPECT_NEAR(measured.angle_norm, expected.angle_norm, 1e-8);
}

TEST_F(OfflineTest, TrainAndPredictMeetInTheModelFileAndAgreeWithEvaluate) {
  expectAgreement(session_, config_, 2);
}

// With physics as the mean, too, and the model needs nothing but its file: the simulation is gone.
TEST_F(OfflineTest, TheyAgreeWithPhysicsAsTheMean) {
  const fs::path simulations = fs::path(folder_.path()) / "simulations";
  fs::create_directory(simulations);
  fs::copy_file("config/simulation/raven2_left_case2014.yaml", simulations / "like.yaml");
  fs::copy_file("config/robots/raven2_left.yaml", simulations / "raven2_left.yaml");
  std::ofstream(config_, std::ios::app) << "physics: {simulation: simulations/like.yaml}\n";
  expectAgreement(session_, config_, 2);
  EXPECT_FALSE(readModelFile(model_).physics.empty());
  fs::remove_all(simulations);
  const std::string out = folder_.path() + "/again.csv";
  EXPECT_EQ(
      offline({"predict", "--model", model_, "--states", session_ + "/observations.csv", "-o", out})
          .code,
      0);
}

TEST_F(OfflineTest, TrainTakesASimulationAsTheMeanAndRefusesThatOfAnotherRobot) {
  const std::string json = folder_.path() + "/train.json";
  ASSERT_EQ(offline({"train", session_, "-o", model_, "--config", config_, "--json", json,
                     "--simulation", "config/simulation/raven2_left_case2014.yaml"})
                .code,
            0);
  std::ifstream file(json);
  const auto numbers = nlohmann::json::parse(file);
  EXPECT_EQ(numbers["physics"]["simulation"], "raven2_left_case2014");
  EXPECT_LT(numbers["physics"]["rms_position_mm"], numbers["rigid"]["rms_position_mm"]);
  const std::string other = folder_.path() + "/other.bag";
  expectRefused(offline({"train", session_, "-o", other, "--config", config_, "--simulation",
                         "config/simulation/raven2_right.yaml"}),
                "raven2_right");
  expectRefused(offline({"train", session_, "-o", other, "--config", config_, "--simulation",
                         folder_.path() + "/nowhere.yaml"}),
                "no such file");
  EXPECT_FALSE(fs::exists(other));
}

TEST_F(OfflineTest, ExperimentPhysicsWritesItsCurves) {
  const std::string json = folder_.path() + "/curves.json";
  const std::string like = "config/simulation/raven2_left_case2014.yaml";
  ASSERT_EQ(
      offline({"experiment", "physics", session_, "--simulation", like, "--config", config_,
               "--pairs", "30", "90", "--folds", "3", "--draw", "trajectories", "--json", json})
          .code,
      0);
  std::ifstream file(json);
  const auto numbers = nlohmann::json::parse(file);
  EXPECT_EQ(numbers["rows"].size(), 7u);
  EXPECT_EQ(numbers["saved"].size(), 2u);
  expectRefused(offline({"experiment", "physics", session_, "--simulation", like, like, "--folds",
                         "3", "--config", config_}),
                "one per fold");
  EXPECT_EQ(offline({"experiment", "physics", session_}).code, 2);
}

TEST_F(OfflineTest, TheyAgreeOnTheMeasuredSessionWithTheShippedConfiguration) {
  const std::string path = testData("case2014_left/dataset.yaml");
  RAVEN_SKIP_WITHOUT_DATA(path, "case2014_left");
  expectAgreement(path.substr(0, path.rfind('/')), "config/trainer.yaml", 1);
}

TEST_F(OfflineTest, PredictAnswersEveryRowAndRefusesWhatIsNoPose) {
  ASSERT_EQ(offline({"train", session_, "-o", model_, "--config", config_}).code, 0);
  const std::string states = folder_.path() + "/states.csv", out = folder_.path() + "/out.csv";
  std::ofstream(states) << "trajectory,stamp,x,y,z,qx,qy,qz,qw\n"
                           "a,1.00,-0.02,-0.06,-0.14,-0.5,0.5,0.5,0.5\n"
                           "a,1.02,nan,-0.06,-0.14,-0.5,0.5,0.5,0.5\n"
                           "a,1.04,-0.02,-0.06,-0.14,0,0,0,0\n"
                           "a,0.90,-0.02,-0.06,-0.14,-0.5,0.5,0.5,0.5\n"
                           "a,1.06,-0.02,-0.06,-0.14,-0.5,0.5,0.5,0.5\n";
  ASSERT_EQ(offline({"predict", "--model", model_, "--states", states, "-o", out}).code, 0);
  std::ifstream file(out);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 6u);
  EXPECT_EQ(lines[1].find("nan"), std::string::npos) << lines[1];
  EXPECT_NE(lines[2].find("refused_not_finite"), std::string::npos) << lines[2];
  EXPECT_NE(lines[3].find("refused_not_unit"), std::string::npos) << lines[3];
  EXPECT_NE(lines[4].find("refused_time_backwards"), std::string::npos) << lines[4];
  EXPECT_NE(lines[4].find(",nan,nan,nan"), std::string::npos) << lines[4];
  EXPECT_EQ(lines[5].find("nan"), std::string::npos) << lines[5];
}

TEST_F(OfflineTest, SimulatesTwoArmsAtATime) {
  const std::string left = "config/simulation/raven2_left_case2014.yaml";
  const std::string right = "config/simulation/raven2_right.yaml";
  const std::string l = folder_.path() + "/left", r = folder_.path() + "/right.bag";
  ASSERT_EQ(offline({"simulate", "--simulation", left, "--simulation", right, "--trajectories", "3",
                     "--seed", "3", "-o", l, "-o", r})
                .code,
            0);
  EXPECT_EQ(readInput(l).arm, "raven2_left");
  const Dataset a = readInput(l), b = readInput(r);
  ASSERT_EQ(a.trajectories.size(), 3u);
  ASSERT_EQ(b.trajectories.size(), 3u);
  const auto middle = [](const Dataset& dataset) {
    return dataset.trajectories[0].commands.front().pose.p.x();
  };
  EXPECT_NEAR(middle(a) - middle(b), 0.1086, 1e-3) << "each over its own half";
  EXPECT_NEAR(a.trajectories[0].start(), b.trajectories[0].start(), 1e-6) << "at the same time";

  const std::string more = folder_.path() + "/more";
  expectRefused(offline({"simulate", "--simulation", left, "--simulation", right, "-o", more}),
                "2 simulations and 1 outputs");
  expectRefused(
      offline({"simulate", "--simulation", left, "--simulation", right, "-o", more, "-o", more}),
      "same output twice");
  expectRefused(offline({"simulate", "--simulation", left, "--simulation", right, "--commands",
                         session_, "-o", more, "-o", more + "2"}),
                "once per arm");
  EXPECT_FALSE(fs::exists(more));
}

TEST_F(OfflineTest, SimulatesASessionForIdentification) {
  const std::string out = folder_.path() + "/excitation";
  ASSERT_EQ(offline({"simulate", "--motion", "excitation", "--simulation",
                     "config/simulation/nominal.yaml", "-o", out})
                .code,
            0);
  const Dataset dataset = readDatasetDirectory(out);
  EXPECT_EQ(dataset.trajectories.size(), 36u);
  EXPECT_EQ(offline({"simulate", "--motion", "dance", "-o", out + "2"}).code, 2);
}

TEST_F(OfflineTest, ExperimentFidelityWritesItsRows) {
  const std::string json = folder_.path() + "/fidelity.json";
  const std::vector<std::string> command{"experiment",
                                         "fidelity",
                                         session_,
                                         "--simulation",
                                         "config/simulation/raven2_left_case2014.yaml",
                                         "--config",
                                         config_,
                                         "--json",
                                         json};
  EXPECT_EQ(offline(command).code, 0);
  std::ifstream file(json);
  const nlohmann::json parsed = nlohmann::json::parse(file);
  ASSERT_GT(parsed["rows"].size(), 50u);
  EXPECT_EQ(parsed["rows"][0].size(), 4u);
  for (const char* key : {"quantity", "measured", "simulated", "unit"})
    EXPECT_TRUE(parsed["rows"][0].contains(key)) << key;
  EXPECT_EQ(offline({"experiment"}).code, 2);
  EXPECT_EQ(offline({"experiment", "nothing"}).code, 2);
  expectRefused(offline({"experiment", "fidelity", session_, "--hold-out", "5/5"}), "5/5");
}

// A page says how it was made: the command, which can be pasted, and its inputs.
TEST_F(OfflineTest, ReportsSayWhereTheyComeFrom) {
  const std::string page = folder_.path() + "/my page.html";
  ASSERT_EQ(offline({"train", session_, "-o", model_, "--config", config_, "--hold-out", "1/5",
                     "--report", page})
                .code,
            0);
  std::ostringstream text;
  text << std::ifstream(page).rdbuf();
  const std::string html = text.str();
  for (const std::string& part :
       {std::string("./run offline train "), "&#39;" + page + "&#39;", session_ + "/commands.csv",
        std::string("--hold-out 1/5 left out"), std::string("max_hyper_points: 80")})
    EXPECT_NE(html.find(part), std::string::npos) << part;
  expectRefused(offline({"train", session_, "-o", folder_.path() + "/other.bag", "--report",
                         folder_.path() + "/nowhere/page.html"}),
                "no such directory");
  expectRefused(offline({"diagnose", session_, "--report", folder_.path() + "/nowhere/r.html"}),
                "no such directory");
}

TEST_F(OfflineTest, BadInputIsExitCodeTwoWithTheReasonAndNothingWritten) {
  expectRefused(offline({"train", "/nowhere", "-o", model_}), "/nowhere");
  expectRefused(offline({"train", session_, "-o", model_, "--config", "/nowhere.yaml"}),
                "nowhere.yaml");
  expectRefused(
      offline({"train", session_, "-o", model_, "--config", config_, "--hold-out", "5/5"}),
      "hold-out");
  expectRefused(offline({"predict", "--model", session_ + "/dataset.yaml", "--states", "x", "-o",
                         folder_.path() + "/c.csv"}),
                "not a complete bag");
  expectRefused(offline({"evaluate", folder_.path()}), "dataset.yaml");
  std::ofstream(config_) << "cleaning: {speed: 0.000001}\n";
  expectRefused(offline({"train", session_, "-o", model_, "--config", config_}), "nothing left");
  EXPECT_FALSE(fs::exists(model_));
  EXPECT_EQ(offline({}).code, 2);
  expectRefused(offline({"fly"}), "there is no command fly; these are: import, export, ");
  EXPECT_EQ(offline({"train"}).code, 2);
  EXPECT_EQ(offline({"--help"}).code, 0);
}

/// A straight line in the first of two features.
void writeLine(const std::string& file, int rows, double from) {
  std::ofstream out(file);
  out << "a,b,y\n";
  for (int i = 0; i < rows; ++i) {
    const double a = from + 0.05 * i;
    out << a << ',' << (i * 7) % 5 << ',' << 3.0 * a + 2.0 << '\n';
  }
}

TEST(OfflineRegress, WritesWhatItFound) {
  const TemporaryDirectory folder;
  const std::string train = folder.path() + "/train.csv", test = folder.path() + "/test.csv";
  const std::string json = folder.path() + "/result.json";
  writeLine(train, 60, 0.0);
  writeLine(test, 40, 0.02);
  for (const std::string backend : {"exact", "sparse"}) {
    const Outcome outcome =
        offline({"regress", "--train", train, "--test", test, "--targets", "1", "--kernel",
                 "squared_exponential", "--backend", backend, "--json", json});
    ASSERT_EQ(outcome.code, 0) << outcome.text;
    const auto result = nlohmann::json::parse(std::ifstream(json));
    ASSERT_EQ(result["outputs"].size(), 1u);
    for (const char* const key : {"smse", "rmse", "nlpd", "coverage95"})
      EXPECT_TRUE(result["outputs"][0][key].is_number()) << key;
    EXPECT_LT(result["outputs"][0]["smse"], 1e-3);
    for (const char* const key : {"hyperparameters", "posterior", "predict"})
      EXPECT_GE(result["seconds"][key], 0.0) << key;
    EXPECT_TRUE(result["log_marginal_likelihood"].is_number());
    EXPECT_EQ(result["n_train"], 60);
    EXPECT_EQ(result["n_test"], 40);
    EXPECT_EQ(result["backend"], backend);
    EXPECT_EQ(result["kernel"], "squared_exponential");
  }
}

TEST(OfflineRegress, BadTablesAndNamesAreExitCodeTwo) {
  const TemporaryDirectory folder;
  const std::string train = folder.path() + "/train.csv", test = folder.path() + "/test.csv";
  writeLine(train, 30, 0.0);
  writeLine(test, 10, 0.0);
  const auto regress = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"regress", "--train", train, "--test", test};
    words.insert(words.end(), more.begin(), more.end());
    return offline(words);
  };
  EXPECT_EQ(regress({}).code, 2);  // --targets is missing
  expectRefused(regress({"--targets", "3"}), "at least one target and one feature");
  expectRefused(regress({"--targets", "1", "--kernel", "cubic"}), "matern52");
  expectRefused(regress({"--targets", "1", "--backend", "nystrom"}), "exact or sparse");
  expectRefused(regress({"--targets", "1", "--exact-points", "0"}), "max_exact_points = 0");
  std::ofstream(test) << "a,c,y\n1,2,3\n";
  expectRefused(regress({"--targets", "1"}), "different columns");
  std::ofstream(test) << "a,b,y\n1,nan,3\n";
  expectRefused(regress({"--targets", "1"}), "test.csv");
}

TEST_F(OfflineTest, AnExistingModelIsKept) {
  std::ofstream(model_) << "precious";
  expectRefused(offline({"train", session_, "-o", model_, "--config", config_}), "exists");
  std::string content;
  std::ifstream(model_) >> content;
  EXPECT_EQ(content, "precious");
}

TEST_F(OfflineTest, AnEmptyBagIsRefused) {
  const std::string empty = folder_.path() + "/empty.bag";
  rosbag::Bag(empty, rosbag::bagmode::Write).close();
  expectRefused(offline({"train", empty, "-o", model_}), "no message on servo_cp");
}

TEST_F(OfflineTest, StampsOutOfOrderAreRefusedInBagsAndDirectories) {
  Dataset dataset = readDatasetDirectory(session_);
  PoseStream& seen = dataset.trajectories[4].observations;
  std::swap(seen[10].stamp, seen[20].stamp);
  const std::string backward = folder_.path() + "/backward", bag = folder_.path() + "/backward.bag";
  writeDatasetDirectory(dataset, backward);
  expectRefused(offline({"train", backward, "-o", model_, "--config", config_}),
                "before the row above; sort the rows");
  // A bag in which messages arrived in another order than they were stamped.
  {
    rosbag::Bag out(bag, rosbag::bagmode::Write);
    ros::Time arrival(1.0);
    for (const Trajectory& trajectory : dataset.trajectories) {
      const auto write = [&](const char* topic, const PoseStream& stream) {
        for (const StampedPose& sample : stream)
          out.write(topic, arrival += ros::Duration(1e-3),
                    stampedPoseToMsg(sample.stamp, sample.pose, dataset.frame));
      };
      write(topics::kCommand, trajectory.commands);
      write(topics::kMocap, trajectory.observations);
    }
  }
  for (const char* const command : {"train", "export"})
    expectRefused(offline({command, bag, "-o", model_}), "mocap/measured_cp: message ");
  expectRefused(offline({"evaluate", bag, "--config", config_}), "rosbag filter");
  EXPECT_FALSE(fs::exists(model_));
}

TEST_F(OfflineTest, RecordingsThatCannotBeTrustedAreRefusedUnlessForced) {
  Dataset dataset = readDatasetDirectory(session_);
  for (Trajectory& trajectory : dataset.trajectories)
    for (StampedPose& sample : trajectory.observations) sample.stamp -= 0.5;
  const std::string early = folder_.path() + "/early";
  writeDatasetDirectory(dataset, early);
  for (const char* const command : {"train", "evaluate"}) {
    std::vector<std::string> words{command, early, "--config", config_};
    if (command == std::string("train")) words.insert(words.end(), {"-o", model_});
    const Outcome refused = offline(words);
    expectRefused(refused, "error: observations: clock");
    expectRefused(refused, "--ignore-checks");
    EXPECT_FALSE(fs::exists(model_));
  }
  // Joints of the other arm: named where both robots are. (Bags hold joints beside poses.)
  const std::string left = "config/robots/raven2_left.yaml";
  const std::string right = "config/robots/raven2_right.yaml";
  const std::string bag = folder_.path() + "/left.bag";
  ASSERT_EQ(offline({"simulate", "--trajectories", "10", "-o", bag, "--simulation",
                     "config/simulation/raven2_left_case2014.yaml"})
                .code,
            0);
  std::vector<std::string> words{"train", bag,       "-o",  model_,    "--config",
                                 config_, "--robot", right, "--robot", left};
  expectRefused(offline(words), "the arms are mixed up");
  EXPECT_FALSE(fs::exists(model_));
  words.push_back("--ignore-checks");
  const Outcome forced = offline(words);
  EXPECT_EQ(forced.code, 0) << forced.text;
  EXPECT_NE(forced.text.find("the arms are mixed up"), std::string::npos) << forced.text;
}

TEST_F(OfflineTest, FewerThanFiveTrajectoriesCannotBeEvaluated) {
  const std::string small = folder_.path() + "/small";
  ASSERT_EQ(offline({"simulate", "--trajectories", "4", "-o", small, "--simulation",
                     "config/simulation/raven2_left_case2014.yaml"})
                .code,
            0);
  expectRefused(offline({"evaluate", small, "--config", config_}), "at least 5");
}

}  // namespace
}  // namespace raven_correction
