// SPDX-License-Identifier: BSD-3-Clause
// What a simulation gets wrong about a recording: measured minus simulated, sample by sample, and
// how large that is. Which parameters make it smaller is effect_fit.h.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "raven_correction/diagnosis/recording.h"
#include "raven_correction/simulation/simulation_config.h"

namespace raven_correction {

/// One kind of residual, with a scale of its own.
struct Channel {
  std::string name;  ///< "position", "orientation", "elbow", "encoder elbow"
  std::string unit;  ///< "m" or "rad"
  int size = 1;      ///< components: 3 or 1
  bool encoder = false;
};

/// A piece of the residual vector that counts as one observation: robust losses look at its length.
struct ResidualBlock {
  int channel = 0;
  int motion = 0;
  int sample = 0;           ///< index into the motion's observations
  Eigen::Index offset = 0;  ///< of its first component
};

class TimelineCache;

/// How the residual vector of a recording is laid out; the same for every simulation.
struct ResidualLayout {
  std::vector<Channel> channels;
  std::vector<ResidualBlock> blocks;  ///< motion by motion, by stamp
  Eigen::Index size = 0;
  int motions = 0;
  /// What residuals() keeps of the recording from one simulation to the next.
  std::shared_ptr<TimelineCache> timelines;

  /// Components of a block: those of its channel.
  int sizeOf(const ResidualBlock& block) const {
    return channels[static_cast<std::size_t>(block.channel)].size;
  }
};
/// @param use  one per motion: which to look at; empty: all
inline bool isUsed(const std::vector<bool>& use, int motion) {
  return use.empty() || use[static_cast<std::size_t>(motion)];
}

ResidualLayout residualLayout(const Recording& recording);

/// What a simulation says of every sample: one column per block, that of all channels of a sample
/// the same.
struct SimulatedSamples {
  Eigen::MatrixXd joints;        ///< joint side [rad or m]
  Eigen::VectorXd since_start;   ///< of the session [s]
  Eigen::Matrix4Xd orientation;  ///< of the tool in base, x y z w: the frame of the orientation
                                 ///< residual; 0 of joint data and of encoder samples
  /// Orientation of the tool at one block; the identity where there is none.
  Eigen::Quaterniond tool(std::size_t block) const;
};

/// Runs the simulation on the whole recording, from rest at its first set-point. Between two
/// motions the arm goes to where the next one starts, so plays keep their history. Thread-safe.
///
///   position     p_measured - p_simulated, in base [m]
///   orientation  log(R_simulated' R_measured), in the simulated tool's frame [rad]
///   joints       q_measured - q_simulated [rad or m]
///
/// @param simulation  of the recording's robot; its internal step is set to the longest one, which
///        changes results by less than a micrometre (doc/simulation.md, exactness)
/// @param simulated   if not null: what it says of every sample
/// @param use         one per motion: the residuals of the others are not wanted and stay 0, and so
///                    does what is said of their samples; empty: all
/// @return layout.size numbers
Eigen::VectorXd residuals(const Recording& recording, const ResidualLayout& layout,
                          const SimulationConfig& simulation, SimulatedSamples* simulated = nullptr,
                          const std::vector<bool>& use = {});

/// Whether a joint of this simulation depends on gravity or payload, and so on all joints before.
bool needsLoad(const SimulationConfig& simulation);
/// Whether residuals() of two simulations that differ in this effect alone differ by no more than
/// where the links put the tool and what is seen of it: their joints are the same.
bool leavesJointsAlone(const SimulationConfig& simulation, const std::string& effect);
/// residuals() of a simulation whose joints move as those of another one, at the price of its
/// forward kinematics.
/// @param simulated  by the other one: its joints and instants
/// @param residual   of the other one: what is not a pose stays as it is
Eigen::VectorXd residualsOfJoints(const Recording& recording, const SimulationConfig& simulation,
                                  const SimulatedSamples& simulated,
                                  const Eigen::VectorXd& residual);

/// Robust standard deviation of the components of every channel: 1.4826 times the median of their
/// absolute values, and not below what can be measured at all (1 um, 0.01 mrad).
/// @param use  one per motion: which to look at; empty: all
Eigen::VectorXd channelScales(const ResidualLayout& layout, const Eigen::VectorXd& residual,
                              const std::vector<bool>& use = {});

/// Huber's loss: s^2 / 2 up to `threshold`, linear beyond. Source: Huber 1964,
/// doi:10.1214/aoms/1177703732
double huber(double s, double threshold) noexcept;
/// Where the loss of a block of `size` whitened components turns linear: 3 sqrt(size), as the
/// length of a vector of unit components grows with sqrt(size) [-].
double blockThreshold(int size) noexcept;

/// Mean Huber loss of the blocks of each motion, with every component divided by its channel's
/// scale. Channels count equally, however many blocks they have.
/// @return one number per motion; nan for a motion without blocks
Eigen::VectorXd motionLosses(const ResidualLayout& layout, const Eigen::VectorXd& residual,
                             const Eigen::VectorXd& scales);

/// Weight of one component of each channel, so that channels count equally however many they have:
/// the mean count over the channel's own; 0 for a channel without blocks [-].
Eigen::VectorXd channelWeights(const ResidualLayout& layout);

/// Weight of every row of the residual vector in whitened robust least squares: Huber's weight of
/// its block over the squared scale of its channel, channels counting equally.
Eigen::VectorXd rowWeights(const ResidualLayout& layout, const Eigen::VectorXd& residual,
                           const Eigen::VectorXd& scales);

/// Sizes of errors for people [m and rad]. Encoder channels do not count.
struct ErrorSizes {
  double position_rms = 0.0, position_median = 0.0, position_p95 = 0.0;
  double orientation_median = 0.0, orientation_rms = 0.0;
  std::vector<double> joint_rms, joint_median, joint_p95;  ///< joint data: per joint
  std::size_t samples = 0;
};
/// @param use  one per motion; empty: all
ErrorSizes errorSizes(const ResidualLayout& layout, const Eigen::VectorXd& residual,
                      const std::vector<bool>& use = {});

}  // namespace raven_correction
