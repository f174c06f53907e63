// SPDX-License-Identifier: BSD-3-Clause
// Where a motion will be a little later, where the planner has announced its whole path: poses
// without times, one for each pose of the stream that follows. motion.h knows the past alone.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "raven_correction/geometry/stream.h"

namespace raven_correction {

/// Whether a pose of the stream is this pose of the path, but for rounding: within 1 um and 1 urad.
bool isPathPose(const Pose& pose, const Pose& of_path) noexcept;

/// Compares the stream with the path pose by pose, and learns from its stamps how fast it goes.
/// Whatever does not fit (another pose, a pause in the middle, stamps at another pace) makes it say
/// nothing: until the pace is known again, or, after a pose that is not on the path, for good. All
/// members but the constructor neither allocate nor throw.
class PathFollower {
 public:
  static constexpr std::size_t kCapacity = 16384;  ///< poses; of a longer path nothing is known

  PathFollower();

  /// A path begins: a first pose and others. Forgets the one before.
  void begin() noexcept;
  /// The next pose of it, in the frame of the stream.
  void add(const Pose& pose) noexcept;
  std::size_t size() const noexcept { return path_.size(); }

  /// The pose of the stream at a stamp. Stamps increase.
  void follow(double stamp, const Pose& desired) noexcept;
  /// Takes back the last follow(), as if that pose had never come.
  void undo() noexcept { state_ = before_; }
  /// Where the stream will be `lead` after the pose that was followed last; at the end of the path
  /// it rests. Nothing where that is not known.
  /// @param lead  >= 0 [s]
  std::optional<Pose> ahead(double lead) const noexcept;

 private:
  struct State {
    bool lost = true;           // no path, or a pose was not on it
    bool followed = false;      // `last` and `stamp` are of a pose of the stream
    std::size_t last = 0;       // index of the pose that came last
    double stamp = 0.0;         // of it [s]
    std::size_t anchor = 0;     // index of the pose since which the pace is even
    double anchor_stamp = 0.0;  // of it [s]
    double period = 0.0;        // between two poses [s]; 0: not known
  };
  std::optional<std::size_t> find(double stamp, const Pose& desired) const noexcept;

  std::vector<Pose> path_;  // capacity kCapacity
  bool too_long_ = false;
  State state_, before_;
};

}  // namespace raven_correction
