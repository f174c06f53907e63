// SPDX-License-Identifier: BSD-3-Clause
// Recorded sessions as data sets: reading bags (doc/bags.md says what they hold) and writing data
// sets as bags. The live recorder writes bags message by message.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "raven_correction/dataset/stream_check.h"
#include "raven_correction/dataset/trajectory.h"

namespace raven_correction {

/// What a trajectory was meant to do, from its events; for comparing visits of targets.
struct TrajectoryGoal {
  std::string trajectory;
  double start = 0.0;  ///< [s]
  double end = 0.0;    ///< [s]
  Pose target;         ///< in base; valid where has_target
  bool has_target = false;
};

struct Session {
  Dataset dataset;                    ///< poses in base; sorted by start
  std::vector<TrajectoryGoal> goals;  ///< one per trajectory of the data set, same order
  std::vector<double> homed_at;  ///< homings that the recorder saw or held possible, in order [s]
};

/// Is called now and then with the share that is read, 0 to 1; what it throws ends the reading.
using ShareRead = std::function<void(double)>;

/// Reads a session from one bag. Poses of mocap/measured_cp are registered into the base frame by
/// the bag's /tf_static. Raw streams are kept as they are, also what is not finite.
/// @throws InvalidInput  no such file, not a bag, damaged or cut off (run `rosbag reindex`), no
///         command or no observation in it, topics of another message type, stamps that go back on
///         a topic (the text has the message and how to cut the bag there), or no registration (the
///         text names the frames)
Session readSessionBag(const std::string& file);

/// Whether the file is a bag with an index and motion capture among its topics; whether what is in
/// its chunks is sound, reading it says.
bool holdsSession(const std::string& file);

/// A bag, or a data set directory, whichever the path is.
/// @throws InvalidInput  neither, or see readSessionBag() and readDatasetDirectory()
Dataset readInput(const std::string& path);
/// Inputs as a service call names them: those that are nowhere else are looked for in the
/// directory; none stands for all bags of sessions there, by name.
/// @throws InvalidInput  none was named, and there is none
std::vector<std::string> inputsNamed(const std::vector<std::string>& names,
                                     const std::string& directory);
/// All inputs as one data set, sorted by start. Parts NAME_0.bag, NAME_1.bag, ... of a recording
/// that was split are read as one session, in the order of their numbers. Trajectory names that
/// occur twice get the name of their input in front.
/// @throws InvalidInput  no input, different base frames, or see readInput()
Dataset readInputs(const std::vector<std::string>& paths, const ShareRead& progress = {});

/// The same, with what is known beside the streams, and what the checks of the streams say.
struct CheckedInputs {
  Dataset dataset;
  double homed_at = 0.0;  ///< last homing before or in the recordings; 0: not known [s]
  std::vector<StreamFinding> findings;
};
/// @param arms  whose joints they may be, see StreamCheckOptions
/// @throws InvalidInput  see readInputs(); findings are no exception (refuseErrors())
CheckedInputs readCheckedInputs(const std::vector<std::string>& paths,
                                const std::vector<ArmKinematics>& arms,
                                const ShareRead& progress = {});

/// Writes pose streams and trajectory events; `frame` of the data set is the frame of all poses.
/// Measured joints go to measured_js; commanded joints beside commanded poses are left out.
/// @throws InvalidInput  the file exists or cannot be written, or a trajectory has no commanded
/// poses
void writeSessionBag(const Dataset& dataset, const std::string& file);

}  // namespace raven_correction
