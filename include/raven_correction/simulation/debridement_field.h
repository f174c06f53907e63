// SPDX-License-Identifier: BSD-3-Clause
// What really lies on the field, and what the grippers hold of it: jaws close and open, fragments
// leave the field, come to their receptacle, or fall back. What a planner believes of it is
// fragment_book.h.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "raven_correction/simulation/debridement_scene.h"
#include "raven_correction/simulation/grasp.h"

namespace raven_correction {

struct DebridementFieldConfig {
  GraspConfig grasp;
  std::vector<Eigen::Vector3d> p_field_receptacle;  ///< their openings [m]
  double receptacle_radius = 0.025;  ///< a fragment that is let go further away falls beside [m]
  double field_size = 0.08;          ///< a fragment that falls outside this square is lost [m]
};

/// What became of a jaw that closed or opened.
struct JawOutcome {
  enum class Kind {
    kHeld,       ///< closed: a fragment is in it
    kMissed,     ///< closed: it held none of them
    kDelivered,  ///< opened over a receptacle: the fragment is in it
    kDropped,    ///< opened elsewhere: the fragment fell back onto the field
    kLost,       ///< opened elsewhere: it fell beside the field
    kEmpty       ///< opened: nothing was in it
  };
  Kind kind = Kind::kEmpty;
  int fragment = -1;  ///< number in the scene as it was set; -1: none
  GraspFit fit;       ///< of the fragment that it held, or of the nearest one
};
const char* toString(JawOutcome::Kind kind) noexcept;

/// What lies under a fragment that is taken stays where it is.
class DebridementField {
 public:
  /// @throws InvalidInput  see checkGrasp(), or a size that is not positive
  explicit DebridementField(const DebridementFieldConfig& config);

  /// A new scene; the grippers are empty.
  void set(const DebridementScene& scene);
  /// What lies there now. Fragments that were taken are not among them.
  const DebridementScene& scene() const noexcept { return scene_; }
  /// @param gripper  name
  /// @param opening  of the jaw before it closed [rad]
  JawOutcome close(const std::string& gripper, const Pose& X_field_tool, double opening);
  JawOutcome open(const std::string& gripper, const Pose& X_field_tool);
  int delivered() const noexcept { return delivered_; }
  int lost() const noexcept { return lost_; }

 private:
  struct Held {
    FoamFragment fragment;
    int number = -1;
  };
  void putDown(const Held& held, const Eigen::Vector2d& p_field);

  DebridementFieldConfig config_;
  DebridementScene scene_;
  std::vector<int> numbers_;           // of scene_.fragments
  std::vector<FragmentTruth> truths_;  // likewise
  std::map<std::string, Held> held_;   // by gripper
  int delivered_ = 0;
  int lost_ = 0;
};

}  // namespace raven_correction
