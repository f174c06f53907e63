// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/robot/chain_file.h"

#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/geometry/rotation.h"
#include "raven_correction/robot/yaml_reader.h"

namespace raven_correction {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// A rigid transform given as a 4x4 matrix; a problem if it is not one to 1e-6.
Pose readTransform(YamlReader& reader, const std::string& key) {
  Eigen::Matrix4d M = Eigen::Matrix4d::Identity();
  reader.requiredMatrix(key, M);
  const Eigen::Matrix3d R = M.topLeftCorner<3, 3>();
  const double skew = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(skew < 1e-6) || R.determinant() < 0.0)
    reader.problem(key, format("its 3x3 part is not a rotation (R^T R differs from 1 by %g, "
                               "determinant %g)",
                               skew, R.determinant()));
  if (M.row(3) != Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0))
    reader.problem(key, "its last row must be 0 0 0 1");
  return {M.topRightCorner<3, 1>(), Eigen::Quaterniond(nearestRotation(R)).normalized()};
}

Joint readJoint(YamlReader& reader) {
  Joint joint;
  reader.requiredText("joint", joint.name);
  int type = 0;
  reader.choice("type", type, {"revolute", "prismatic"});
  if (!reader.has("type")) reader.problem("type", "missing; revolute or prismatic");
  joint.type = type == 0 ? JointType::kRevolute : JointType::kPrismatic;
  const double longest = type == 0 ? 4.0 * kPi : 2.0;  // rad or m: catches degrees, millimetres
  reader.requiredNumber("alpha", joint.alpha, -2.0 * kPi, 2.0 * kPi);
  reader.requiredNumber("a", joint.a, -2.0, 2.0);
  reader.requiredNumber("theta_offset", joint.theta_offset, -2.0 * kPi, 2.0 * kPi);
  reader.requiredNumber("d_offset", joint.d_offset, -2.0, 2.0);
  reader.requiredNumber("sign", joint.sign, -1.0, 1.0);
  if (std::abs(joint.sign) != 1.0) {
    reader.problem("sign", "must be 1 or -1");
    joint.sign = 1.0;
  }
  reader.requiredNumber("lower", joint.lower, -longest, longest);
  reader.requiredNumber("upper", joint.upper, -longest, longest);
  if (!(joint.lower < joint.upper)) reader.problem("upper", "must be above lower");
  reader.requiredNumber("home", joint.home, -longest, longest);
  if (!(joint.home >= joint.lower && joint.home <= joint.upper))
    reader.problem("home", format("%g is outside [lower, upper] = [%g, %g]", joint.home,
                                  joint.lower, joint.upper));
  reader.number("mass", joint.mass, 0.0, 100.0);
  Eigen::VectorXd centre = joint.centre_of_mass;
  reader.numbers("centre_of_mass", centre, -2.0, 2.0);
  joint.centre_of_mass = centre;
  reader.refuseUnknownKeys();
  return joint;
}

KinematicChain readChain(YamlReader reader, const std::string& path) {
  std::string name;
  std::string frame;
  std::string description;
  reader.requiredText("name", name);
  reader.requiredText("frame", frame);
  reader.text("description", description);
  const Pose X_base_0 = readTransform(reader, "base");
  const Pose X_n_tool = readTransform(reader, "tool");
  Eigen::VectorXd gravity = Eigen::VectorXd::Zero(3);
  reader.numbers("gravity", gravity, -20.0, 20.0);
  std::vector<Joint> joints;
  for (YamlReader& row : reader.list("joints")) joints.push_back(readJoint(row));
  if (joints.empty()) reader.problem("joints", "missing; one list entry per joint, base first");
  if (reader.has("transmission")) reader.section("transmission");  // loadCableCoupling() reads it
  reader.refuseUnknownKeys();
  reader.throwIfAnyProblem();
  try {
    KinematicChain chain(name, frame, X_base_0, joints, X_n_tool);
    chain.setGravity(gravity);
    return chain;
  } catch (const InvalidInput& error) {
    throw InvalidInput(format("%s: %s", path.c_str(), error.what()));
  }
}

}  // namespace

KinematicChain loadKinematicChain(const std::string& path) {
  return readChain(YamlReader::fromFile(path), path);
}

KinematicChain kinematicChainFromText(const std::string& text, const std::string& name) {
  return readChain(YamlReader::fromText(text, name), name);
}

}  // namespace raven_correction
