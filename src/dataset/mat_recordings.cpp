// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/dataset/mat_recordings.h"

#include <matio.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>

#include "raven_correction/error.h"
#include "raven_correction/geometry/rotation.h"

namespace raven_correction {
namespace {

namespace fs = std::filesystem;

constexpr double kPoseTolerance = 1e-3;  // of a matrix to the pose that it becomes [- or m]
constexpr char kEnding[] = ".mat";

using MatFile = std::unique_ptr<mat_t, decltype(&Mat_Close)>;
using MatVariable = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;

bool isMatFile(const fs::path& path) { return path.extension() == kEnding; }

std::string shapeOf(const matvar_t& variable) {
  std::string text;
  for (int i = 0; i < variable.rank; ++i)
    text += (i ? " x " : "") + std::to_string(variable.dims[i]);
  return text;
}

/// A real matrix of so many columns; trailing dimensions of 1 do not count.
Eigen::MatrixXd matrixOf(mat_t* file, const std::string& path, const char* name,
                         Eigen::Index columns) {
  const MatVariable variable(Mat_VarRead(file, name), Mat_VarFree);
  if (!variable)
    throw InvalidInput(
        format("%s: variable %s is missing or cannot be read; a recording has z, r, c (poses) and "
               "zs, rs, cs "
               "(stamps)",
               path.c_str(), name));
  if (variable->class_type != MAT_C_DOUBLE || variable->isComplex || !variable->data)
    throw InvalidInput(
        format("%s: variable %s must hold real numbers of type double", path.c_str(), name));
  std::vector<std::size_t> shape(variable->dims, variable->dims + variable->rank);
  while (shape.size() > 2 && shape.back() == 1) shape.pop_back();
  if (columns == 1 && shape.size() == 2 && shape[0] == 1) std::swap(shape[0], shape[1]);
  if (shape.size() != 2 || shape[1] != static_cast<std::size_t>(columns) || shape[0] == 0)
    throw InvalidInput(format("%s: variable %s is %s, must be n x %d with n >= 1", path.c_str(),
                              name, shapeOf(*variable).c_str(), static_cast<int>(columns)));
  const Eigen::MatrixXd values = Eigen::Map<const Eigen::MatrixXd>(
      static_cast<const double*>(variable->data), static_cast<Eigen::Index>(shape[0]), columns);
  for (Eigen::Index i = 0; i < values.rows(); ++i)
    if (!values.row(i).allFinite())
      throw InvalidInput(format("%s: variable %s, row %d: a number is not finite; cut the row out",
                                path.c_str(), name, static_cast<int>(i + 1)));
  return values;
}

Pose poseOf(const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>& T, const std::string& place) {
  const Eigen::Matrix3d R = nearestRotation(T.topLeftCorner<3, 3>());
  const double off = std::max((T.topLeftCorner<3, 3>() - R).cwiseAbs().maxCoeff(),
                              (T.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff());
  if (off > kPoseTolerance)
    throw InvalidInput(
        format("%s: not a pose: an entry is %.3g from those of a rotation and a last row of 0 0 0 "
               "1 (at most "
               "%g); is the matrix row-major?",
               place.c_str(), off, kPoseTolerance));
  Pose pose;
  pose.p = T.topRightCorner<3, 1>();
  pose.q = Eigen::Quaterniond(R);
  return pose;
}

PoseStream streamOf(mat_t* file, const std::string& path, const std::string& name) {
  const Eigen::MatrixXd poses = matrixOf(file, path, name.c_str(), 16);
  const std::string stamps_name = name + "s";
  const Eigen::VectorXd stamps = matrixOf(file, path, stamps_name.c_str(), 1);
  if (stamps.size() != poses.rows())
    throw InvalidInput(format("%s: %s has %d rows, but %s has %d", path.c_str(), name.c_str(),
                              static_cast<int>(poses.rows()), stamps_name.c_str(),
                              static_cast<int>(stamps.size())));
  PoseStream stream(static_cast<std::size_t>(poses.rows()));
  for (Eigen::Index i = 0; i < poses.rows(); ++i) {
    StampedPose& sample = stream[static_cast<std::size_t>(i)];
    sample.stamp = stamps(i);
    if (i > 0 && stamps(i) < stamps(i - 1))
      throw InvalidInput(format("%s: %s, row %d: stamp %.6f is before the one above; sort the rows",
                                path.c_str(), stamps_name.c_str(), static_cast<int>(i + 1),
                                stamps(i)));
    Eigen::Matrix<double, 4, 4, Eigen::RowMajor> T;
    for (Eigen::Index k = 0; k < 16; ++k) T(k / 4, k % 4) = poses(i, k);
    sample.pose =
        poseOf(T, format("%s: %s, row %d", path.c_str(), name.c_str(), static_cast<int>(i + 1)));
    if (i > 0) {  // signs of quaternions are continuous
      const Eigen::Quaterniond& before = stream[static_cast<std::size_t>(i - 1)].pose.q;
      if (before.dot(sample.pose.q) < 0.0) sample.pose.q.coeffs() *= -1.0;
    }
  }
  return stream;
}

std::vector<std::string> filesOf(const std::vector<std::string>& paths) {
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    if (!fs::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    std::vector<std::string> here;
    for (const fs::directory_entry& entry : fs::directory_iterator(path))
      if (isMatFile(entry.path())) here.push_back(entry.path().string());
    if (here.empty())
      throw InvalidInput(format("%s: no *%s file in this directory", path.c_str(), kEnding));
    std::sort(here.begin(), here.end());
    files.insert(files.end(), here.begin(), here.end());
  }
  if (files.empty()) throw InvalidInput("no recording; give *.mat files or directories of them");
  return files;
}

}  // namespace

Dataset readMatRecordings(const std::vector<std::string>& paths, const std::string& frame) {
  Dataset dataset;
  dataset.name = "recordings";
  dataset.description = "MATLAB recordings of commands, encoders and cameras";
  dataset.frame = frame;
  std::set<std::string> known;
  for (const std::string& path : filesOf(paths)) {
    if (!fs::exists(path)) throw InvalidInput(format("%s: no such file", path.c_str()));
    const MatFile file(Mat_Open(path.c_str(), MAT_ACC_RDONLY), Mat_Close);
    if (!file)
      throw InvalidInput(
          format("%s: not a MATLAB file (level 5 or 7.3), or cut short", path.c_str()));
    Trajectory trajectory;
    trajectory.id = fs::path(path).stem().string();
    if (!known.insert(trajectory.id).second)
      throw InvalidInput(
          format("%s: another file is called %s, too; names are the trajectories' ids",
                 path.c_str(), trajectory.id.c_str()));
    trajectory.commands = streamOf(file.get(), path, "z");
    trajectory.encoders = streamOf(file.get(), path, "r");
    trajectory.observations = streamOf(file.get(), path, "c");
    dataset.trajectories.push_back(std::move(trajectory));
    dataset.source += (dataset.source.empty() ? "" : ", ") + path;
  }
  sortByStart(dataset);
  return dataset;
}

bool holdsMatRecordings(const std::string& path) {
  const fs::path place(path);
  if (!fs::is_directory(place)) return isMatFile(place);
  if (fs::exists(place / "dataset.yaml")) return false;
  return std::any_of(fs::directory_iterator(place), fs::directory_iterator(),
                     [](const fs::directory_entry& entry) { return isMatFile(entry.path()); });
}

}  // namespace raven_correction
