// SPDX-License-Identifier: BSD-3-Clause
// One physical reason why a robot errs: its parameters, its stage in the chain from command to
// observation, and what it does there. The catalogue of all effects is effect_registry.h.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "raven_correction/geometry/pose.h"
#include "raven_correction/robot/kinematic_chain.h"

namespace raven_correction {

/// In the order in which the stages act.
enum class EffectStage {
  kCommand,      ///< when set-points act
  kDrive,        ///< set-point to motor, in joint units; encoders see it
  kCable,        ///< motor to joint; encoders do not see it
  kKinematics,   ///< joint to tool pose
  kObservation,  ///< tool pose to what motion capture reports
};
const char* toString(EffectStage stage) noexcept;

/// One number of an effect. Its nominal value, 0, leaves the simulation as if the effect were
/// absent.
struct EffectParameter {
  std::string symbol;      ///< as in the effect's equation and in YAML, e.g. `w`
  int joint = -1;          ///< the joint it belongs to (row of the chain), -1 for none
  int source = -1;         ///< second joint of a coupling: the one that causes the motion, or -1
  std::string unit;        ///< "rad", "m", "s", "rad/Nm", ...
  double lower = 0.0;      ///< smallest allowed value, in that unit
  double upper = 0.0;      ///< largest allowed value
  double value = 0.0;      ///< within [lower, upper]
  double deviation = 0.0;  ///< standard deviation of the value where it was fitted, else 0
};
/// "w[shoulder]", "c[elbow<-shoulder]" or "tau", as a person reads it.
std::string parameterLabel(const EffectParameter& parameter, const KinematicChain& robot);

/// What an effect may know of the present step. References live as long as the call.
struct StepContext {
  double time;              ///< at the end of the step, since the start of the session [s]
  double step;              ///< duration of the step, > 0 [s]
  const JointVector& home;  ///< homing position of every joint [rad or m]
  const JointVector& load;  ///< gravity and payload on every joint, positive along +q [Nm or N]
  /// CableCoupling::motorTravel() of the robot; null where every motor moves one joint.
  const JointMatrix* motor_travel = nullptr;
};

/// Base of all effects. An effect is immutable once it is part of a simulation: what it remembers
/// from step to step (a play, a lag) is handed in as `memory` and belongs to the arm's state.
/// A derived class overrides the one hook of its stage, and, where what it does depends on the past
/// or is seen in the observation, the way back (undo(), undoObserve()).
class Effect {
 public:
  virtual ~Effect() = default;
  virtual const char* name() const noexcept = 0;  ///< snake_case, as in YAML
  virtual EffectStage stage() const noexcept = 0;
  virtual const char* equation() const noexcept = 0;  ///< one line, for people
  virtual std::unique_ptr<Effect> clone() const = 0;

  const std::vector<EffectParameter>& parameters() const noexcept { return parameters_; }
  /// @throws InvalidInput  index out of range, value outside [lower, upper] or not finite
  void setValue(int index, double value);
  void setDeviation(int index, double deviation);

  /// kCommand: how much later set-points act [s].
  virtual double delay() const noexcept { return 0.0; }
  /// kDrive, kCable: changes q in place. `memory` is the q that this hook returned last; at a reset
  /// it is the q that came in.
  virtual void apply(const StepContext& /*context*/, JointVector& /*memory*/,
                     JointVector& /*q*/) const noexcept {}
  /// kDrive, kCable: what apply() returns depends on `memory`.
  virtual bool remembers() const noexcept { return false; }
  /// kDrive, kCable: the way back, from the q that apply() returns to the one that came in, as far
  /// as the past tells it: inverse_arm.h. Here for effects without memory: Newton steps on apply();
  /// q stays as it is where they do not converge. An effect with memory has a way of its own.
  /// @param context  of the instant; `load` is that of the joints as they are
  /// @param memory   one's own from instant to instant; at a reset it is the q that comes in
  /// @param speed    of the joints, changed along with q [rad/s or m/s]
  virtual void undo(const StepContext& context, JointVector& memory, JointVector& speed,
                    JointVector& q) const noexcept;
  /// kDrive, kCable: apply() reads StepContext::load.
  virtual bool needsLoad() const noexcept { return false; }
  /// kKinematics: the chain as it really is.
  virtual KinematicChain links(const KinematicChain& nominal) const { return nominal; }
  /// kKinematics: where the robot's base really is, X_base_robot.
  virtual Pose base() const noexcept { return {}; }
  /// kKinematics: what is observed, in the nominal tool frame, X_tool_observed.
  virtual Pose tool() const noexcept { return {}; }
  /// kObservation: the observed pose in `base` at `time` [s since the start of the session].
  virtual Pose observe(double /*time*/, const Pose& X_base_tool) const noexcept {
    return X_base_tool;
  }
  /// kObservation: the way back.
  virtual Pose undoObserve(double /*time*/, const Pose& X_observed) const noexcept {
    return X_observed;
  }

 protected:
  /// What a parameter of a joint is for a revolute and for a prismatic one: from -limit, or from 0,
  /// to limit.
  struct JointRange {
    const char* revolute_unit;
    double revolute_limit;
    const char* prismatic_unit;
    double prismatic_limit;
  };
  enum class Sign { kBoth, kNotNegative };
  void addParameter(EffectParameter parameter);
  /// A parameter with one value for the whole effect.
  void addParameter(const char* symbol, const char* unit, double lower, double upper);
  /// One parameter per joint, in the order of the joints.
  void addJointParameters(const char* symbol, const KinematicChain& robot, const JointRange& range,
                          Sign sign);
  /// x, y, z [m] and the rotation vector rx, ry, rz [rad] of a small rigid transform.
  void addPoseParameters(double translation_limit, double rotation_limit);
  /// The transform whose parameters start at `first`.
  Pose poseValue(int first) const noexcept;
  double value(int index) const noexcept { return values_[static_cast<std::size_t>(index)]; }

 private:
  std::vector<EffectParameter> parameters_;
  std::vector<double> values_;  // of parameters_, side by side for speed
};

}  // namespace raven_correction
