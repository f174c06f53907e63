// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/robot/remote_centre_arm.h"

#include <cmath>

namespace raven_correction {
namespace {

constexpr double kRightAngle = 1e-6;    // |cos(alpha)| below this is a right angle
constexpr double kUndetermined = 1e-9;  // a direction shorter than this is none [m]
constexpr double kReach = 1e-9;         // |cos| may exceed 1 by this much from rounding

bool isRevolute(const Joint& joint) { return joint.type == JointType::kRevolute; }

}  // namespace

std::shared_ptr<const RemoteCentreArm> RemoteCentreArm::make(const KinematicChain& chain) {
  if (chain.size() != 6) return nullptr;
  const std::vector<Joint>& rows = chain.joints();
  for (const int i : {0, 1, 4, 5})
    if (!isRevolute(rows[i]) || rows[i].d_offset != 0.0) return nullptr;
  if (isRevolute(rows[2]) == isRevolute(rows[3])) return nullptr;
  for (const int i : {0, 1, 2, 3, 4})
    if (rows[i].a != 0.0) return nullptr;
  if (rows[3].alpha != 0.0) return nullptr;
  if (std::abs(std::cos(rows[4].alpha)) > kRightAngle) return nullptr;
  if (std::abs(std::cos(rows[5].alpha)) > kRightAngle) return nullptr;
  if (std::abs(std::sin(rows[1].alpha)) < 1e-3 || std::abs(std::sin(rows[2].alpha)) < 1e-3)
    return nullptr;

  const std::shared_ptr<RemoteCentreArm> arm(new RemoteCentreArm);
  const Pose first_turn{Eigen::Vector3d::Zero(), Eigen::Quaterniond(Eigen::AngleAxisd(
                                                     rows[0].alpha, Eigen::Vector3d::UnitX()))};
  arm->X_0_base_ = (chain.baseTransform() * first_turn).inverse();
  arm->X_tool_n_ = chain.toolTransform().inverse();
  arm->roll_ = isRevolute(rows[2]) ? 2 : 3;
  arm->insertion_ = 5 - arm->roll_;
  arm->cos_1_ = std::cos(rows[1].alpha);
  arm->sin_1_ = std::sin(rows[1].alpha);
  arm->cos_2_ = std::cos(rows[2].alpha);
  arm->sin_2_ = std::sin(rows[2].alpha);
  arm->sin_4_ = std::sin(rows[4].alpha) > 0.0 ? 1.0 : -1.0;
  arm->sin_5_ = std::sin(rows[5].alpha) > 0.0 ? 1.0 : -1.0;
  arm->wrist_ = rows[5].a;
  for (int i = 0; i < 6; ++i) {
    arm->sign_(i) = rows[i].sign;
    arm->offset_(i) = rows[i].theta_offset;
  }
  // Roll and insertion share an axis: their constant turns and shifts add up.
  arm->offset_(arm->roll_) = rows[2].theta_offset + rows[3].theta_offset;
  arm->offset_(arm->insertion_) = rows[2].d_offset + rows[3].d_offset;
  return arm;
}

int RemoteCentreArm::solve(const Pose& X_base_tool, const JointVector& seed,
                           Solutions& solutions) const noexcept {
  const Pose X_0_6 = X_0_base_ * X_base_tool * X_tool_n_;
  const Eigen::Matrix3d R_0_6 = X_0_6.q.toRotationMatrix();
  const Eigen::Vector3d x6 = R_0_6.col(0);
  const Eigen::Vector3d z6 = R_0_6.col(2);
  const Eigen::Vector3d across = X_0_6.p - X_0_6.p.dot(z6) * z6;
  const double across_length = across.norm();
  if (across_length < kUndetermined) return 0;
  const Eigen::Vector3d y5 = -sin_5_ * z6;

  int count = 0;
  for (const double x_side : {1.0, -1.0}) {
    const Eigen::Vector3d x5 = (x_side / across_length) * across;
    const Eigen::Vector3d z5 = x5.cross(y5);
    const Eigen::Vector3d pitch_point = X_0_6.p - wrist_ * x5;
    const double reach = pitch_point.norm();
    if (reach < kUndetermined) continue;
    const double yaw = std::atan2(sin_5_ * x6.dot(z5), x6.dot(x5));
    for (const double shaft_side : {1.0, -1.0}) {
      const double insertion = shaft_side * reach;
      const Eigen::Vector3d shaft = pitch_point / insertion;
      double cos_elbow = (cos_1_ * cos_2_ - shaft.z()) / (sin_1_ * sin_2_);
      if (std::abs(cos_elbow) > 1.0 + kReach) continue;
      cos_elbow = std::min(1.0, std::max(-1.0, cos_elbow));
      const double sin_elbow_size = std::sqrt((1.0 - cos_elbow) * (1.0 + cos_elbow));
      for (const double elbow_side : {1.0, -1.0}) {
        const double sin_elbow = elbow_side * sin_elbow_size;
        // The shaft's direction with the shoulder at zero, and with it the shoulder's angle.
        const double shaft_x = sin_2_ * sin_elbow;
        const double shaft_y = -cos_1_ * sin_2_ * cos_elbow - sin_1_ * cos_2_;
        const double length = std::hypot(shaft_x, shaft_y) * std::hypot(shaft.x(), shaft.y());
        double c = 1.0;
        double s = 0.0;
        double shoulder;
        if (length > 1e-12) {
          c = (shaft_x * shaft.x() + shaft_y * shaft.y()) / length;
          s = (shaft_x * shaft.y() - shaft_y * shaft.x()) / length;
          shoulder = std::atan2(s, c);
        } else {  // the shaft lies on the first axis
          shoulder = sign_(0) * seed(0) + offset_(0);
          c = std::cos(shoulder);
          s = std::sin(shoulder);
        }
        // Axes x, y of the shaft frame at roll zero, in frame 0.
        const Eigen::Vector3d x_shoulder(c, s, 0.0);
        const Eigen::Vector3d y_elbow(-cos_1_ * s, cos_1_ * c, sin_1_);
        const Eigen::Vector3d x_shaft = cos_elbow * x_shoulder + sin_elbow * y_elbow;
        const Eigen::Vector3d y_shaft = shaft.cross(x_shaft);
        const double roll_x = -sin_4_ * z5.dot(y_shaft);
        const double roll_y = sin_4_ * z5.dot(x_shaft);
        // Pitch: x5 turned away from the rolled x axis, towards the rolled y axis of the pitch row.
        const Eigen::Vector3d x_rolled = roll_x * x_shaft + roll_y * y_shaft;
        const double pitch = std::atan2(sin_4_ * x5.dot(shaft), x5.dot(x_rolled));
        JointVector& q = solutions[static_cast<std::size_t>(count++)];
        q.resize(6);
        q(0) = shoulder;
        q(1) = std::atan2(sin_elbow, cos_elbow);
        q(roll_) = std::atan2(roll_y, roll_x);
        q(insertion_) = insertion;
        q(4) = pitch;
        q(5) = yaw;
        q = (sign_.array() * (q.array() - offset_.array())).matrix();
      }
    }
  }
  return count;
}

}  // namespace raven_correction
