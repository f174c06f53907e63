// SPDX-License-Identifier: BSD-3-Clause
// Recordings of the plant with hidden causes and their truth: the entrance to the plant. For robots
// with kinematics, seen by motion capture; joints alone are joint_session.h.
//
//   PlantOptions options;  options.seed = 7;
//   const HiddenEffect hidden = drawHidden(options, 7, 5.0, 30.0);  // 5 to 30 times the noise
//   const PlantSession session = recordHidden(options, {hidden});
//   diagnose(session.dataset) ... compare with session.truth
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "plant/cameras.h"
#include "plant/hidden_effect.h"
#include "plant/motion.h"
#include "plant/outside.h"
#include "raven_correction/dataset/trajectory.h"

namespace raven_correction::plant {

struct PlantOptions {
  /// Relative to the folder of the package, where tests run.
  std::string robot_file = "config/robots/raven2_left.yaml";
  int trajectories = 40;     ///< of about 2.5 s each
  bool encoders = false;     ///< record motor positions, too: as poses and joints
  bool dirt = true;          ///< of motion capture
  double noise = 1e-4;       ///< of positions per axis [m]; orientations have 52 rad per m of it
  double frame_rate = 110;   ///< of motion capture [Hz]
  double command_rate = 60;  ///< [Hz]
  double start = 1000.0;     ///< stamp of the first command [s]
  std::uint64_t seed = 1;    ///< of the motion and of the cameras
};

struct PlantSession {
  /// Commands and observations, in `base`; with encoders also nominal joint set-points, and motor
  /// positions as poses (`encoders`) and in joint units (`joint_observations`).
  Dataset dataset;
  std::vector<HiddenEffect> truth;  ///< empty for a clean one
  std::string outside;              ///< name of the cause outside the catalogue, or empty
  double outside_size_mm = 0.0;     ///< as HiddenEffect::size_mm
  double outside_size_deg = 0.0;
  /// The same motion seen by perfect cameras, with every exposure. Here `joint_observations` are
  /// the real joints, and `encoders` the poses of the motors.
  Dataset noise_free;
};

PlantSession recordClean(const PlantOptions& options);
/// @throws InvalidInput  as applyEffect()
PlantSession recordHidden(const PlantOptions& options, const std::vector<HiddenEffect>& hidden);
/// @param size  aimed at, in multiples of the noise (see multiplesOfNoise()) [-]
/// @param seed  chooses the joint, where the kind is of one
PlantSession recordOutside(const PlantOptions& options, OutsideKind kind, double size,
                           std::uint64_t seed);

struct ToolSize {
  double mm = 0.0;   ///< rms displacement of the observed point
  double deg = 0.0;  ///< rms turn
};
/// How much these causes together move the observed tool, against the clean plant.
ToolSize sizeOf(const PlantOptions& options, const std::vector<HiddenEffect>& hidden);
/// The larger of position over position noise and turn over orientation noise: 0.1 mm and 0.3 deg
/// for the default noise.
double multiplesOfNoise(const ToolSize& size);

/// The same cause at this size in multiples of the noise, within 10 %, or as large as is plausible
/// (see plausible() of hidden_effect.h); found on a short session, so the size in a long one
/// differs a little.
HiddenEffect scaledTo(const PlantOptions& options, const HiddenEffect& hidden, double size);

/// Effect, joint, sign and size from a seed; the size is drawn evenly in its logarithm. Joints on
/// which no plausible effect is that large are not drawn.
/// @param smallest, largest  in multiples of the noise
/// @throws InvalidInput  an unknown effect, or no joint shows one of that size
HiddenEffect drawHidden(const PlantOptions& options, std::uint64_t seed, double smallest,
                        double largest);
/// The same for a given effect.
HiddenEffect drawHidden(const PlantOptions& options, const std::string& effect, std::uint64_t seed,
                        double smallest, double largest);
/// Several different effects at once.
std::vector<HiddenEffect> drawHiddenSet(const PlantOptions& options, std::uint64_t seed, int count,
                                        double smallest, double largest);

}  // namespace raven_correction::plant
