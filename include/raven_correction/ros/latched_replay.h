// SPDX-License-Identifier: BSD-3-Clause
// The first message of a latched publisher may be from yesterday, and is no command. When a command
// acts is arrival.h.
#pragma once

#include <ros/datatypes.h>

#include <boost/shared_ptr.hpp>
#include <boost/weak_ptr.hpp>
#include <vector>

namespace raven_correction {

/// Knows connections, not names: a planner that was started anew, or advertises again, replays its
/// last message, too. For any number of topics. Not thread-safe.
class LatchedReplay {
 public:
  LatchedReplay() { seen_.reserve(16); }
  /// @param connection  of the message (MessageEvent::getConnectionHeaderPtr()): the same object
  /// for
  ///                    all that come over one connection
  /// @return true for the first one, if its publisher latches
  bool isReplay(const boost::shared_ptr<ros::M_string>& connection);

 private:
  std::vector<boost::weak_ptr<ros::M_string>>
      seen_;  // latched connections, and some that have ended
};

}  // namespace raven_correction
