// SPDX-License-Identifier: BSD-3-Clause
// The checks of dataset/stream_check.h while streams come in: samples from the thread that has
// them, the work (and the questions to the master about topics) in a thread of its own.
#pragma once

#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>

#include <mutex>
#include <string>
#include <vector>

#include "raven_correction/dataset/stream_check.h"
#include "raven_correction/dataset/topic_check.h"

namespace raven_correction {

/// Thread-safe.
class StreamWatch {
 public:
  /// @param options   with a window: what came lately is checked, every few seconds
  /// @param expected  topics that have to be published
  StreamWatch(const StreamCheckOptions& options, std::vector<TopicType> expected);
  ~StreamWatch();

  /// See StreamCheck; no more than a copy is made here.
  void addPose(StreamRole role, double stamp, double arrival, const std::string& frame,
               const Pose& pose, const Pose* X_base_frame);
  void addJoints(double stamp, double arrival, const std::vector<std::string>& names,
                 const std::vector<double>& positions);
  /// Forgets samples and what was found in them.
  void clear();
  /// The latest: of topics, then of streams.
  std::vector<StreamFinding> findings() const;

 private:
  void look();

  const std::vector<TopicType> expected_;
  mutable std::mutex mutex_;  // of what follows, to the findings
  StreamCheck check_;
  std::size_t samples_ = 0, looked_at_ = 0;  // since the start; when look() was here last
  std::size_t clearings_ = 0;
  std::vector<StreamFinding> of_topics_, of_streams_;

  ros::CallbackQueue queue_;
  ros::WallTimer timer_;
  ros::AsyncSpinner spinner_;
};

}  // namespace raven_correction
