// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/dataset/mat_recordings.h"

#include <gtest/gtest.h>
#include <matio.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "raven_correction/dataset/dataset_directory.h"
#include "raven_correction/error.h"
#include "raven_correction/geometry/rotation.h"
#include "support/temporary_directory.h"
#include "support/test_data.h"

namespace raven_correction {
namespace {

/// Variables of a recording, n x 16 and n x 1.
struct Recording {
  Eigen::MatrixXd z, r, c, zs, rs, cs;
};

Pose turned(int row, double offset) {
  return {Eigen::Vector3d(0.01 * row, -0.02 * row, offset),
          expRotation(Eigen::Vector3d(0.9 * row, 0.3, offset))};
}

Recording recording(double start, int rows = 4) {
  Recording made;
  const auto fill = [&](double offset, Eigen::MatrixXd& poses, Eigen::MatrixXd& stamps) {
    poses.resize(rows, 16);
    stamps.resize(rows, 1);
    for (int i = 0; i < rows; ++i) {
      const Pose pose = turned(i, offset);
      Eigen::Matrix<double, 4, 4, Eigen::RowMajor> T = Eigen::Matrix4d::Identity();
      T.topLeftCorner<3, 3>() = pose.q.toRotationMatrix();
      T.topRightCorner<3, 1>() = pose.p;
      poses.row(i) = Eigen::Map<const Eigen::RowVectorXd>(T.data(), 16);
      stamps(i, 0) = start + 0.02 * i + offset;
    }
  };
  fill(0.0, made.z, made.zs);
  fill(0.001, made.r, made.rs);
  fill(0.002, made.c, made.cs);
  return made;
}

void write(const std::string& path, const Recording& made, mat_ft version = MAT_FT_MAT5) {
  mat_t* const file = Mat_CreateVer(path.c_str(), nullptr, version);
  ASSERT_NE(file, nullptr);
  const auto put = [&](const char* name, const Eigen::MatrixXd& values) {
    if (values.size() == 0) return;
    // As released: n x 16 x 1 poses, n x 1 stamps.
    std::size_t shape[] = {std::size_t(values.rows()), std::size_t(values.cols()), 1};
    matvar_t* const variable =
        Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, values.cols() == 1 ? 2 : 3, shape,
                      const_cast<double*>(values.data()), 0);
    EXPECT_EQ(Mat_VarWrite(file, variable, MAT_COMPRESSION_NONE), 0);
    Mat_VarFree(variable);
  };
  put("z", made.z);
  put("r", made.r);
  put("c", made.c);
  put("zs", made.zs);
  put("rs", made.rs);
  put("cs", made.cs);
  Mat_Close(file);
}

/// What readMatRecordings() says of the paths.
std::string refusalOf(const std::vector<std::string>& paths) {
  try {
    readMatRecordings(paths);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

void expectSaid(const std::string& refusal, const std::vector<std::string>& words) {
  for (const std::string& word : words)
    EXPECT_NE(refusal.find(word), std::string::npos) << word << " is not in: " << refusal;
}

class MatRecordings : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }

  const TemporaryDirectory folder_;
};

TEST_F(MatRecordings, AreReadAsWritten) {
  write(path("late_L_1_L.mat"), recording(20.0));
  write(path("early_L_2_L.mat"), recording(10.0), MAT_FT_MAT73);
  std::ofstream(path("notes.txt")) << "not a recording\n";
  ASSERT_TRUE(holdsMatRecordings(folder_.path()));
  ASSERT_TRUE(holdsMatRecordings(path("late_L_1_L.mat")));
  const Dataset dataset = readMatRecordings({folder_.path()});
  EXPECT_EQ(dataset.frame, "0_link");
  ASSERT_EQ(dataset.trajectories.size(), 2u);
  EXPECT_EQ(dataset.trajectories[0].id, "early_L_2_L");
  EXPECT_EQ(dataset.trajectories[1].id, "late_L_1_L");
  const Trajectory& late = dataset.trajectories[1];
  ASSERT_EQ(late.commands.size(), 4u);
  ASSERT_EQ(late.encoders.size(), 4u);
  ASSERT_EQ(late.observations.size(), 4u);
  for (int i = 0; i < 4; ++i) {
    const StampedPose& seen = late.observations[std::size_t(i)];
    EXPECT_EQ(seen.stamp, 20.0 + 0.02 * i + 0.002);
    EXPECT_LT((seen.pose.p - turned(i, 0.002).p).norm(), 1e-15);
    EXPECT_LT(rotationAngle(seen.pose.q, turned(i, 0.002).q), 1e-7);
    const Pose& before = late.observations[std::size_t(std::max(0, i - 1))].pose;
    EXPECT_GE(seen.pose.q.dot(before.q), 0.0);
    EXPECT_LT((late.encoders[std::size_t(i)].pose.p - turned(i, 0.001).p).norm(), 1e-15);
    EXPECT_LT((late.commands[std::size_t(i)].pose.p - turned(i, 0.0).p).norm(), 1e-15);
  }
}

TEST_F(MatRecordings, BadOnesSayWhatIsWrong) {
  const std::string file = path("bad.mat");
  const auto refusal = [&](const Recording& made) {
    write(file, made);
    return refusalOf({file});
  };
  Recording bad = recording(0.0);
  bad.r.resize(0, 0);
  expectSaid(refusal(bad), {file, "variable r is missing"});
  bad = recording(0.0);
  bad.c = bad.c.leftCols(15).eval();
  expectSaid(refusal(bad), {"variable c is 4 x 15", "n x 16"});
  bad = recording(0.0);
  bad.z(2, 3) = std::nan("");
  expectSaid(refusal(bad), {"variable z, row 3", "not finite"});
  bad = recording(0.0);
  bad.zs(3, 0) = -1.0;
  expectSaid(refusal(bad), {"zs, row 4", "before the one above"});
  bad = recording(0.0);
  bad.z(1, 0) += 0.01;
  expectSaid(refusal(bad), {"z, row 2", "not a pose"});
  bad = recording(0.0);
  bad.cs = bad.cs.topRows(3).eval();
  expectSaid(refusal(bad), {"c has 4 rows", "cs has 3"});
  std::ofstream(file) << "this is no MATLAB file";
  expectSaid(refusalOf({file}), {file, "not a MATLAB file"});
  expectSaid(refusalOf({path("none.mat")}), {"no such file"});
  std::filesystem::create_directory(path("empty"));
  expectSaid(refusalOf({path("empty")}), {"no *.mat file"});
  EXPECT_FALSE(holdsMatRecordings(path("empty")));
}

/// What the package's measured session holds of the same recordings, to the digits of its files.
TEST(MatSample, EqualsTheTablesOfTheMeasuredSession) {
  const std::string sample = testData("case2014_mat_sample"), tables = testData("case2014_left");
  if (sample.empty() || tables.empty())
    GTEST_SKIP() << "case2014_mat_sample or case2014_left is not there; set RAVEN_CORRECTION_DATA";
  const Dataset released = readMatRecordings({sample});
  const Dataset measured = readDatasetDirectory(tables);
  const std::vector<std::pair<std::string, std::string>> same = {
      {"move_holding_data_L_10_L", "t030"},
      {"move_towards_foam_data_L_12_L", "t037"},
      {"check_pickup_data_L_100_L", "t302"}};
  ASSERT_EQ(released.trajectories.size(), same.size());
  for (std::size_t k = 0; k < same.size(); ++k) {
    const Trajectory& one = released.trajectories[k];
    EXPECT_EQ(one.id, same[k].first);
    const auto other =
        std::find_if(measured.trajectories.begin(), measured.trajectories.end(),
                     [&](const Trajectory& trajectory) { return trajectory.id == same[k].second; });
    ASSERT_NE(other, measured.trajectories.end()) << same[k].second;
    const auto expectEqual = [&](const PoseStream& a, const PoseStream& b) {
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_NEAR(a[i].stamp, b[i].stamp, 6e-7);
        EXPECT_LT((a[i].pose.p - b[i].pose.p).cwiseAbs().maxCoeff(), 1e-9);
        EXPECT_LT(rotationAngle(a[i].pose.q, b[i].pose.q), 1e-7);
      }
    };
    expectEqual(one.commands, other->commands);
    expectEqual(one.encoders, other->encoders);
    expectEqual(one.observations, other->observations);
  }
}

}  // namespace
}  // namespace raven_correction
