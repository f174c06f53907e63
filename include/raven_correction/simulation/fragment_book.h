// SPDX-License-Identifier: BSD-3-Clause
// What a planner knows of the fragments on the field: what was seen last, who is working on what,
// how often it was tried in vain. Keeps arms that share the field apart. What is really there is
// debridement_field.h.
#pragma once

#include <Eigen/Core>
#include <mutex>
#include <optional>
#include <vector>

namespace raven_correction {

/// A fragment as a camera sees it; in the frame of the field.
struct FragmentSighting {
  Eigen::Vector3d p_field = Eigen::Vector3d::Zero();  ///< centre of its volume [m]
  double yaw = 0.0;                                   ///< of its long axis about z [rad]
  double length = 0.008;                              ///< along that axis [m]
  double width = 0.006;                               ///< across [m]
  bool partly_hidden = false;                         ///< another one lies on it
};

/// All that one picture of the field shows.
struct FieldPicture {
  double stamp = 0.0;  ///< when it was taken [s]
  std::vector<FragmentSighting> fragments;
};

/// Which part of the field belongs to an arm, lower <= x < upper, and where it waits. Arms that
/// wait or carry stay above their own part, so that two of them meet at neighbouring fragments
/// only.
struct FieldPart {
  double lower = -1.0;                                     ///< [m]
  double upper = 1.0;                                      ///< [m]
  Eigen::Vector3d p_field_home = Eigen::Vector3d::Zero();  ///< nearest fragments first [m]
};

struct FragmentBookConfig {
  double same = 0.0025;       ///< what is seen no further from there is the same fragment [m]
  double separation = 0.030;  ///< between the fragments that two arms work on, seen from above [m]
  double reach = 0.012;       ///< a jaw that closes may take what lies no further from there [m]
  unsigned attempts = 4;      ///< in vain, until a fragment is given up, >= 1
};

/// Thread-safe: one thread per arm.
class FragmentBook {
 public:
  /// @param parts  one per arm
  /// @throws InvalidInput  no part, a length that is negative, or attempts = 0
  FragmentBook(const FragmentBookConfig& config, std::vector<FieldPart> parts);

  /// What a picture shows; older knowledge is forgotten, but for what was tried. A picture older
  /// than the one before says nothing new.
  void see(const FieldPicture& picture);

  enum class Next {
    kWork,    ///< here is one, and it is this arm's until leave()
    kWait,    ///< the other arm works too near to what is left
    kIdle,    ///< nothing is left in this arm's part, but what the other drops or uncovers may be
    kNothing  ///< nothing is left in this arm's part, and nobody works
  };
  struct Choice {
    Next next = Next::kNothing;
    FragmentSighting fragment;
    unsigned tried = 0;  ///< so often in vain
  };
  /// Uncovered fragments come before covered ones, then those that were tried less often, then
  /// the nearest to the arm's home.
  Choice choose(std::size_t arm);
  /// The arm's fragment in a picture, if it still lies there.
  std::optional<FragmentSighting> stillThere(std::size_t arm, const FieldPicture& picture) const;
  /// Whether another fragment than the arm's own, within reach of its jaw, has gone since the
  /// picture that was seen last: the jaw has taken that one.
  bool tookNeighbour(std::size_t arm, const FieldPicture& now) const;
  /// The attempt on the arm's fragment was in vain. @return true if it is given up now
  bool failed(std::size_t arm);
  /// The arm has left the field.
  void leave(std::size_t arm);
  /// Fragments that were given up.
  unsigned givenUp() const;

 private:
  struct Tried {
    Eigen::Vector3d p_field;
    unsigned attempts;
  };
  unsigned attemptsAt(const Eigen::Vector3d& p_field) const;
  bool tooNear(std::size_t arm, const Eigen::Vector3d& p_field) const;

  FragmentBookConfig config_;
  std::vector<FieldPart> parts_;
  mutable std::mutex mutex_;  // guards what follows
  FieldPicture seen_;
  std::vector<std::optional<FragmentSighting>> claims_;  // by arm
  std::vector<Tried> tried_;
};

}  // namespace raven_correction
