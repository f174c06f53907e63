// SPDX-License-Identifier: BSD-3-Clause
// What the stereo camera and the fragment detector say of the field at a moment of one's choice.
// The time that a simulated picture takes to be drawn and searched does not pass in the simulation.
#pragma once

#include <ros/ros.h>

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>

#include "raven_correction/FragmentArray.h"
#include "raven_correction/simulation/fragment_book.h"

namespace raven_correction {

/// Thread-safe: the eye of several arms.
class FieldEye {
 public:
  /// @param camera     namespace of camera and detector
  /// @param simulator  node whose ~pause lets the clock stand
  FieldEye(const std::string& camera, const std::string& simulator);

  /// A picture that is taken now. `meanwhile` is what the caller does in the time that a picture
  /// takes in the simulation; if camera and detector need longer, the clock stands until they have
  /// finished.
  /// @throws std::runtime_error  there is no picture, or no answer of the detector
  FieldPicture look(const std::function<void()>& meanwhile);
  /// Real time for which the clock stood [s].
  double stood();

 private:
  void onFragments(const FragmentArray& message);
  void pause(bool stand);

  std::string take_picture_, pause_;
  std::mutex mutex_;  // guards what follows
  std::condition_variable arrived_;
  FieldPicture newest_;
  std::mutex pause_mutex_;  // guards what follows
  int standing_ = 0;        // so many wait for a picture
  ros::SteadyTime since_;
  double stood_ = 0.0;
  ros::Subscriber subscriber_;  // last: its callback uses the above
};

}  // namespace raven_correction
