// SPDX-License-Identifier: BSD-3-Clause
// Whether the stamps of one topic run forward. A bag in which they do not is refused
// (session_bag.h), and the recorder leaves such messages out, so that what it writes is accepted.
#pragma once

#include <ros/time.h>

namespace raven_correction {

class StampOrder {
 public:
  /// The next message of the topic. Equal stamps are in order (a frame that was sent twice), and a
  /// stamp of 0 means "not valid" and is not compared.
  /// @return how far the stamp lies before the latest() one [s]; 0 if it is in order
  double add(const ros::Time& stamp) {
    if (stamp.isZero()) return 0.0;
    if (stamp < latest_) return (latest_ - stamp).toSec();
    latest_ = stamp;
    return 0.0;
  }
  /// Of the messages in order; zero: none yet.
  const ros::Time& latest() const { return latest_; }

 private:
  ros::Time latest_;
};

}  // namespace raven_correction
