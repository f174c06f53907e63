// SPDX-License-Identifier: BSD-3-Clause
// motor_saturation: a motor follows late (T), and at full current it turns no faster than friction
// and load leave it (v, l, f). Cables run over the pulleys of other joints, so on a Raven the roll
// motor has to turn with the insertion; one that does not keep up turns the tool by 138 rad per
// metre that it misses. tracking_lag and speed_limit act on a joint alone and do not do that.
//
//   u_j = q_j + sum_k C_jk q_k                          motor travel, CableCoupling::motorTravel()
//   du_j/dt = clamp((u_j* - u_j) / T_j, -(v_j - L_j), v_j + L_j),   u_j* for q_j at its set-point
//   L_j = l_j + sum_k f_jk (q_k - home_k)               load, as the speed that it gives towards +u
//
// v_j = 0 stands for no limit; a limit below 0 is 0: the motor stalls. Found in the CASE 2014
// recordings: encoders and cameras show the roll dragged along by up to 170 deg.

#include <algorithm>
#include <cmath>
#include <limits>

#include "raven_correction/simulation/effect_registry.h"

namespace raven_correction {
namespace {

/// Speeds that a motor reaches: towards +u, and towards -u. Infinite where it has no limit.
struct Limits {
  double up = std::numeric_limits<double>::infinity();
  double down = std::numeric_limits<double>::infinity();
};

/// How far a motor is behind a goal that moves at the speed s, after `time`: the solution of
///   de/dt = s - clamp(e / T, -down, up),   T = 0: e / T is as large as it has to be,
/// piece by piece: at full speed e changes evenly, below it decays towards s T.
double behindAfter(double e, double s, double T, const Limits& limits, double time) {
  const double above = T > 0.0 ? limits.up * T : 0.0, below = T > 0.0 ? -limits.down * T : 0.0;
  for (int piece = 0; piece < 3; ++piece) {  // catching up, between the limits, falling behind
    const bool fast_up = e > above || (e == above && s > limits.up);
    const bool fast_down = e < below || (e == below && s < -limits.down);
    if (fast_up || fast_down) {
      const double rate = fast_up ? s - limits.up : s + limits.down;
      const double edge = fast_up ? above : below;
      const bool catches_up = fast_up ? rate < 0.0 : rate > 0.0;
      if (!catches_up || (edge - e) / rate >= time) return e + rate * time;
      time -= (edge - e) / rate;
      e = edge;
    }
    if (T == 0.0) {  // it is where it should be, and stays there if it is fast enough
      if (s > limits.up) return (s - limits.up) * time;
      return s < -limits.down ? (s + limits.down) * time : 0.0;
    }
    // Written so that a jump of the goal, a huge s for next to no time, keeps its digits.
    const double decay = std::expm1(-time / T);
    const double end = e * (1.0 + decay) - s * T * decay;
    if (end <= above && end >= below) return end;
    const double edge = end > above ? above : below;
    time = std::max(0.0, time - T * std::log1p((e - edge) / (edge - s * T)));
    e = edge;
  }
  return e;
}

class MotorSaturation final : public Effect {
 public:
  explicit MotorSaturation(const KinematicChain& robot) : size_(robot.size()) {
    addJointParameters("T", robot, {"s", 2.0, "s", 2.0}, Sign::kNotNegative);
    addJointParameters("v", robot, {"rad/s", 200.0, "m/s", 2.0}, Sign::kNotNegative);
    addJointParameters("l", robot, {"rad/s", 200.0, "m/s", 2.0}, Sign::kBoth);
    for (int j = 0; j < size_; ++j) {
      for (int k = 0; k < size_; ++k) {
        if (k == j) continue;
        EffectParameter parameter;
        parameter.symbol = "f";
        parameter.joint = j;
        parameter.source = k;
        parameter.unit = std::string(isRevolute(robot, j) ? "rad/s" : "m/s") +
                         (isRevolute(robot, k) ? "/rad" : "/m");
        parameter.upper =
            (isRevolute(robot, j) ? 200.0 : 2.0) * (isRevolute(robot, k) ? 1.0 : 100.0);
        parameter.lower = -parameter.upper;
        addParameter(parameter);
      }
    }
  }
  const char* name() const noexcept override { return "motor_saturation"; }
  EffectStage stage() const noexcept override { return EffectStage::kDrive; }
  const char* equation() const noexcept override {
    return "u = C q, du/dt = clamp((u* - u) / T, -(v - L), v + L), L = l + sum_k f_k (q_k - "
           "home_k)";
  }
  std::unique_ptr<Effect> clone() const override {
    return std::make_unique<MotorSaturation>(*this);
  }

  bool remembers() const noexcept override { return true; }
  void apply(const StepContext& context, JointVector& memory,
             JointVector& q) const noexcept override {
    for (int j = 0; j < size_; ++j) {
      const double T = value(j);
      const double v = value(size_ + j);
      if (T == 0.0 && v == 0.0) continue;
      double before = 0.0;  // travel of this motor for the other joints, at the start of the step
      double after = 0.0;
      double load = value(2 * size_ + j);
      int index = 3 * size_ + j * (size_ - 1);
      for (int k = 0; k < size_; ++k) {
        if (k == j) continue;
        if (v > 0.0) load += value(index) * (q(k) - context.home(k));
        ++index;
        if (context.motor_travel == nullptr) continue;
        before += (*context.motor_travel)(j, k) * memory(k);
        after += (*context.motor_travel)(j, k) * q(k);
      }
      Limits limits;
      if (v > 0.0) limits = {std::max(0.0, v + load), std::max(0.0, v - load)};
      const double speed = (after - before) / context.step;  // of the goal: q_j itself is held
      q(j) -= behindAfter(q(j) - memory(j), speed, T, limits, context.step);
    }
    memory = q;
  }

  /// u* = u + T du/dt. A motor at full current does not tell how far its goal is ahead: it is taken
  /// to be where the same speed would bring it without a limit. In the order against that of
  /// apply(), where each motor sees what those before it have become.
  void undo(const StepContext& context, JointVector& /*memory*/, JointVector& speed,
            JointVector& q) const noexcept override {
    for (int j = size_ - 1; j >= 0; --j) {
      double travel = speed(j);
      for (int k = 0; k < size_ && context.motor_travel != nullptr; ++k)
        if (k != j) travel += (*context.motor_travel)(j, k) * speed(k);
      q(j) += value(j) * travel;
    }
  }

 private:
  static bool isRevolute(const KinematicChain& robot, int joint) {
    return robot.joints()[static_cast<std::size_t>(joint)].type == JointType::kRevolute;
  }
  int size_ = 0;
};

}  // namespace

std::unique_ptr<Effect> makeMotorSaturation(const KinematicChain& robot) {
  return std::make_unique<MotorSaturation>(robot);
}

}  // namespace raven_correction
