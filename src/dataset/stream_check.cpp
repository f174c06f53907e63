// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/dataset/stream_check.h"

#include <algorithm>
#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/geometry/statistics.h"

namespace raven_correction {
namespace {

using Severity = StreamFinding::Severity;

constexpr std::size_t kEnough = 20;    // samples, before anything is said about them
constexpr std::size_t kMaxFrames = 8;  // names that are remembered
constexpr double kBadShare = 0.05;     // of samples that are no poses: a warning [-]
constexpr double kMostly = 0.5;        // of samples: an error [-]
constexpr double kPi = 3.14159265358979323846;
constexpr double kRadiansPerDegree = kPi / 180.0;
constexpr double kTurns = 4.0 * kPi;   // no joint of an arm turns further [rad]
constexpr double kSameInstant = 0.02;  // between joints and encoders [s]

double share(std::size_t part, std::size_t all) {
  return all == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(all);
}

/// "/0_link" is "0_link".
std::string plainFrame(const std::string& frame) {
  return !frame.empty() && frame.front() == '/' ? frame.substr(1) : frame;
}

/// "millimetres", or what else makes the length fit; empty: nothing does.
std::string unitsThatFit(double length, double limit) {
  for (const auto& [scale, unit] : {std::pair{1e-3, "millimetres"}, std::pair{1e-6, "micrometres"}})
    if (length * scale <= limit) return unit;
  return "";
}

}  // namespace

StreamCheck::StreamCheck(StreamCheckOptions options) : options_(std::move(options)) {}

void StreamCheck::clear() { tracks_ = {}; }

void StreamCheck::startTrajectory() {
  for (Track& track : tracks_) {
    track.last_stamp = 0.0;
    track.has_last_pose = false;
  }
}

/// Counts a sample by its stamp.
StreamCheck::Sample& StreamCheck::take(Track& track, double stamp, double arrival) {
  ++track.count;
  Sample sample;
  sample.stamp = stamp;
  sample.arrival = arrival;
  if (stamp > 0.0) {
    if (track.last_stamp > 0.0) sample.interval = stamp - track.last_stamp;
    track.last_stamp = stamp;
  }
  if (options_.window > 0 && track.samples.size() >= options_.window) track.samples.pop_front();
  track.samples.push_back(std::move(sample));
  return track.samples.back();
}

void StreamCheck::addPose(StreamRole role, double stamp, double arrival, std::string_view frame,
                          const Pose& pose, const Pose* X_base_frame) {
  Track& track = tracks_[static_cast<std::size_t>(role)];
  Sample& sample = take(track, stamp, arrival);
  auto known = std::find(track.frames.begin(), track.frames.end(), frame);
  if (known == track.frames.end() && track.frames.size() < kMaxFrames)
    known = track.frames.insert(known, std::string(frame));
  if (known == track.frames.end()) --known;  // one too many in any case
  sample.frame = static_cast<std::uint8_t>(known - track.frames.begin());
  sample.distance = std::numeric_limits<double>::quiet_NaN();
  if (!isFinite(pose)) {
    sample.value = Value::kNotFinite;
    return;
  }
  if (!hasUnitQuaternion(pose)) {
    sample.value = Value::kNotUnit;
    return;
  }
  if (isIdentity(pose)) {  // what a controller sends before it knows better
    sample.value = Value::kIdentity;
    return;
  }
  sample.distance = pose.p.norm();
  sample.repeated = track.has_last_pose && track.last_pose.p == pose.p &&
                    track.last_pose.q.coeffs() == pose.q.coeffs();
  track.last_pose = pose;
  track.has_last_pose = true;
  if (X_base_frame == nullptr || !(stamp > 0.0)) return;
  sample.base = *X_base_frame * pose;
  sample.placed = true;
}

void StreamCheck::addJoints(double stamp, double arrival, const std::vector<std::string>& names,
                            const Eigen::VectorXd& positions) {
  Track& track = tracks_[static_cast<std::size_t>(StreamRole::kJoints)];
  Sample& sample = take(track, stamp, arrival);
  if (track.joint_names != names) {
    for (Sample& before : track.samples) before.joints.resize(0);  // they were others
    track.joint_names = names;
  }
  if (positions.size() == 0) return;
  if (positions.allFinite() && positions.size() == static_cast<Eigen::Index>(names.size()))
    sample.joints = positions;
  else
    sample.value = Value::kNotFinite;
}

std::size_t StreamCheck::countOf(const Track& track, Value value) {
  return static_cast<std::size_t>(
      std::count_if(track.samples.begin(), track.samples.end(),
                    [value](const Sample& sample) { return sample.value == value; }));
}

std::vector<std::string> StreamCheck::framesOf(const Track& track) {
  std::vector<std::string> frames;
  for (std::size_t i = 0; i < track.frames.size(); ++i)
    if (std::any_of(track.samples.begin(), track.samples.end(),
                    [i](const Sample& sample) { return sample.frame == i; }))
      frames.push_back(track.frames[i]);
  return frames;
}

// --- one stream ----------------------------------------------------------------------------------

void StreamCheck::checkStamps(StreamRole role, std::vector<StreamFinding>& findings) const {
  const Track& track = this->track(role);
  const std::size_t count = track.samples.size();
  std::size_t zero_stamps = 0, backwards = 0;
  double furthest_back = 0.0;  // [s]
  for (const Sample& sample : track.samples) {
    zero_stamps += sample.stamp > 0.0 ? 0 : 1;
    backwards += sample.interval < 0.0 ? 1 : 0;
    furthest_back = std::max(furthest_back, -sample.interval);
  }
  const double zero = share(zero_stamps, count);
  if (zero > kBadShare)
    findings.push_back(
        {zero > kMostly ? Severity::kError : Severity::kWarning, name(role), "stamps",
         format("%zu of %zu are zero", zero_stamps, count), "zero means: not valid",
         role == StreamRole::kObservations
             ? "let the driver fill the header, or set the recorder's mocap_stamp: receipt"
             : "let the source fill the header"});
  if (backwards > 0)
    findings.push_back({Severity::kError, name(role), "order",
                        format("%zu of %zu stamps lie before the one before, by up to %.3f s",
                               backwards, count, furthest_back),
                        "stamps must not go back",
                        "a clock was set back, a bag is played in a loop, or two nodes publish "
                        "there: stop the second one, or record again"});
  std::vector<double> intervals;
  for (const Sample& sample : track.samples)
    if (sample.interval > 0.0 && sample.interval <= options_.pause)
      intervals.push_back(sample.interval);
  if (intervals.size() < kEnough) return;
  const double period = median(intervals);
  if (1.0 / period < options_.min_rate)
    findings.push_back({Severity::kWarning, name(role), "rate", format("%.2f Hz", 1.0 / period),
                        format("at least %g Hz", options_.min_rate),
                        "let it be published faster: motion between samples is not known"});
  double in_gaps = 0.0, all = 0.0;
  for (const double interval : intervals) {
    all += interval;
    if (interval > 3.0 * period) in_gaps += interval;
  }
  if (in_gaps > options_.max_gap_share * all)
    findings.push_back(
        {Severity::kWarning, name(role), "gaps",
         format("%.0f %% of the time lies in intervals above three periods (%.1f ms)",
                100.0 * in_gaps / all, 1e3 * period),
         format("at most %.0f %%", 100.0 * options_.max_gap_share),
         role == StreamRole::kObservations ? "look for lost sight of the markers, or a slow network"
                                           : "look for a source that stutters, or a slow network"});
  std::size_t repeated = 0;
  for (const Sample& sample : track.samples) repeated += sample.repeated ? 1 : 0;
  if (role == StreamRole::kObservations && track.samples.size() >= kEnough &&
      share(repeated, track.samples.size()) > kMostly)
    findings.push_back({Severity::kWarning, name(role), "repeated",
                        format("%.0f %% of the poses are the one before again",
                               100.0 * share(repeated, track.samples.size())),
                        format("at most %.0f %%", 100.0 * kMostly),
                        "the tracker holds its last pose: are the markers in sight?"});
}

void StreamCheck::checkClock(StreamRole role, std::vector<StreamFinding>& findings) const {
  std::vector<double> ages;
  for (const Sample& sample : track(role).samples)
    if (sample.stamp > 0.0 && std::isfinite(sample.arrival))
      ages.push_back(sample.arrival - sample.stamp);
  if (ages.size() < kEnough) return;
  const double age = median(ages);
  const char* const synchronise =
      "synchronise the clocks of the hosts (chrony); a bag that is played needs /use_sim_time";
  if (age < -options_.max_ahead)
    findings.push_back({-age > options_.max_clock ? Severity::kError : Severity::kWarning,
                        name(role), "clock",
                        format("stamps are %.3f s ahead of the clock here", -age),
                        format("at most %g s", options_.max_ahead), synchronise});
  if (age > options_.max_age)
    findings.push_back({age > options_.max_clock ? Severity::kError : Severity::kWarning,
                        name(role), "clock", format("messages come %.3f s after their stamps", age),
                        format("at most %g s", options_.max_age), synchronise});
  const double jitter = quantile(ages, 0.95) - quantile(ages, 0.05);
  if (jitter > options_.max_age)
    findings.push_back(
        {Severity::kWarning, name(role), "clock",
         format("the time from stamp to arrival varies by %.3f s (5 to 95 %%)", jitter),
         format("at most %g s", options_.max_age),
         "look for a slow network, or a source that sends in bursts"});
}

void StreamCheck::checkValues(StreamRole role, std::vector<StreamFinding>& findings) const {
  const Track& track = this->track(role);
  const std::size_t count = track.samples.size();
  const std::size_t not_finite = countOf(track, Value::kNotFinite),
                    not_unit = countOf(track, Value::kNotUnit),
                    identity = countOf(track, Value::kIdentity), bad = not_finite + not_unit;
  if (share(bad, count) > kBadShare)
    findings.push_back(
        {share(bad, count) > kMostly ? Severity::kError : Severity::kWarning, name(role), "values",
         format("%zu of %zu are not finite, %zu have a quaternion that is not of unit length",
                not_finite, count, not_unit),
         format("at most %.0f %%", 100.0 * kBadShare),
         "look at the source: a lost marker, a default message?"});
  if (share(identity, count) > kMostly)
    findings.push_back({Severity::kWarning, name(role), "values",
                        format("%zu of %zu are the identity pose", identity, count),
                        format("at most %.0f %%", 100.0 * kMostly),
                        "the source does not know its pose: is the robot homed?"});
}

void StreamCheck::checkFrame(StreamRole role, std::vector<StreamFinding>& findings) const {
  const Track& track = this->track(role);
  const std::vector<std::string> frames = framesOf(track);
  std::string all;
  for (const std::string& frame : frames) all += (all.empty() ? "\"" : ", \"") + frame + "\"";
  const bool camera = role == StreamRole::kObservations;
  const bool registered = std::any_of(track.samples.begin(), track.samples.end(),
                                      [](const Sample& sample) { return sample.placed; });
  const bool any_frame =
      camera || options_.base_frame.empty() || (role == StreamRole::kEncoders && registered);
  const std::string expected = any_frame ? std::string("one frame for all messages")
                                         : "only \"" + options_.base_frame + "\"";
  bool wrong = frames.size() > 1;
  if (!any_frame)
    for (const std::string& frame : frames)
      wrong |= plainFrame(frame) != plainFrame(options_.base_frame);
  if (wrong)
    findings.push_back({Severity::kError, name(role), "frame", all, expected,
                        camera ? "record one tracked body per topic"
                               : "set base_frame, or let the source transform its poses"});
  else if (camera && std::count(frames.begin(), frames.end(), "") > 0)
    findings.push_back({Severity::kError, name(role), "frame", "messages name no frame",
                        "the frame in which the tracker sees",
                        "let the driver name it, or set mocap_frame"});
}

void StreamCheck::checkUnits(StreamRole role, std::vector<StreamFinding>& findings) const {
  std::vector<double> distances;
  for (const Sample& sample : track(role).samples)
    if (std::isfinite(sample.distance)) distances.push_back(sample.distance);
  if (distances.empty()) return;
  const std::vector<std::string> frames = framesOf(track(role));
  const bool in_base =
      frames.size() == 1 && plainFrame(frames.front()) == plainFrame(options_.base_frame);
  const bool camera = role == StreamRole::kObservations && !in_base;
  const double limit = camera ? options_.max_camera_distance : options_.max_distance;
  const double distance = median(distances);
  if (distance <= limit) return;
  const std::string units = unitsThatFit(distance, limit);
  findings.push_back({Severity::kError, name(role), "units",
                      format("the tool is %.4g m from the origin of its frame", distance),
                      format("at most %g m", limit),
                      units.empty() ? "positions must be in metres, in a frame near the robot"
                                    : "are positions in " + units + "? they must be in metres"});
}

void StreamCheck::checkJointUnits(std::vector<StreamFinding>& findings) const {
  const Track& track = this->track(StreamRole::kJoints);
  for (std::size_t k = 0; k < track.joint_names.size(); ++k) {
    std::vector<double> values;
    for (const Sample& sample : track.samples)
      if (sample.joints.size() > static_cast<Eigen::Index>(k))
        values.push_back(std::abs(sample.joints(static_cast<Eigen::Index>(k))));
    if (values.size() < kEnough || median(values) <= kTurns) continue;
    findings.push_back({Severity::kError, name(StreamRole::kJoints), "units",
                        format("joint %s is at %.4g", track.joint_names[k].c_str(), median(values)),
                        "rad or m", "are joints in degrees or millimetres?"});
    return;
  }
}

// --- joints against encoders ---------------------------------------------------------------------

void StreamCheck::checkArm(std::vector<StreamFinding>& findings) const {
  if (options_.arms.empty()) return;
  const Track& joints = track(StreamRole::kJoints);
  struct Both {
    const Sample *joints, *encoders;
  };
  std::vector<Both> both;
  auto next = joints.samples.begin();
  for (const Sample& encoder : track(StreamRole::kEncoders).samples) {
    if (!encoder.placed) continue;
    const auto nearer = [&](const Sample& a, const Sample& b) {
      return std::abs(a.stamp - encoder.stamp) <= std::abs(b.stamp - encoder.stamp);
    };
    while (next != joints.samples.end() && std::next(next) != joints.samples.end() &&
           nearer(*std::next(next), *next))
      ++next;
    if (next == joints.samples.end()) break;
    if (next->joints.size() > 0 && std::abs(next->stamp - encoder.stamp) <= kSameInstant)
      both.push_back({&*next, &encoder});
  }
  if (both.size() < kEnough) return;
  struct Error {
    double position = std::numeric_limits<double>::infinity(), angle = position;
  };
  const auto errorOf = [&](const ArmKinematics& arm, double scale) {
    std::vector<double> positions, angles;
    const std::size_t step = std::max<std::size_t>(1, both.size() / 500);
    for (std::size_t i = 0; i < both.size(); i += step) {
      const auto tool = arm.forward(joints.joint_names, scale * both[i].joints->joints);
      if (!tool) continue;
      positions.push_back((tool->p - both[i].encoders->base.p).norm());
      angles.push_back(rotationAngle(tool->q, both[i].encoders->base.q));
    }
    return positions.empty() ? Error{} : Error{median(positions), median(angles)};
  };
  const auto fits = [&](const Error& error) {
    return error.position <= options_.max_kinematics_error &&
           error.angle <= options_.max_kinematics_angle;
  };
  const ArmKinematics& own = options_.arms.front();
  const Error error = errorOf(own, 1.0);
  if (fits(error) || !std::isfinite(error.position)) return;
  const std::string measured = format(
      "joints of %s put the tool %.1f mm and %.1f deg from %s", own.name.c_str(),
      1e3 * error.position, error.angle / kRadiansPerDegree, name(StreamRole::kEncoders).c_str());
  const std::string limit =
      format("at most %g mm and %.1f deg", 1e3 * options_.max_kinematics_error,
             options_.max_kinematics_angle / kRadiansPerDegree);
  const std::string& stream = name(StreamRole::kJoints);
  if (fits(errorOf(own, kRadiansPerDegree))) {
    findings.push_back({Severity::kError, stream, "units", measured, limit,
                        "they fit as degrees: joints must be in rad, the insertion in m"});
    return;
  }
  for (std::size_t k = 1; k < options_.arms.size(); ++k) {
    if (!fits(errorOf(options_.arms[k], 1.0))) continue;
    findings.push_back({Severity::kError, stream, "arm", measured, limit,
                        "they fit as those of " + options_.arms[k].name +
                            ": the arms are mixed up, exchange the topics"});
    return;
  }
  findings.push_back({Severity::kWarning, stream, "arm", measured, limit,
                      "is it another arm, another tool, another robot file, or another base "
                      "frame? a topic of the other arm is the worst of these"});
}

// --- together ------------------------------------------------------------------------------------

PoseStream StreamCheck::placed(StreamRole role) const {
  PoseStream stream;
  for (const Sample& sample : track(role).samples)
    if (sample.placed && (stream.empty() || sample.stamp > stream.back().stamp))
      stream.push_back({sample.stamp, sample.base});
  return stream;
}

std::vector<StreamFinding> StreamCheck::findings() const {
  std::vector<StreamFinding> all;
  for (const StreamRole role : {StreamRole::kCommands, StreamRole::kObservations,
                                StreamRole::kEncoders, StreamRole::kJoints}) {
    if (track(role).count == 0) continue;
    checkStamps(role, all);
    checkClock(role, all);
    checkValues(role, all);
    if (role == StreamRole::kJoints) continue;
    checkFrame(role, all);
    checkUnits(role, all);
  }
  checkJointUnits(all);
  checkArm(all);
  return all;
}

std::vector<StreamFinding> StreamCheck::allFindings() const {
  std::vector<StreamFinding> all = findings();
  if (anyError(all)) return all;  // what does not fit by itself does not fit together
  Dataset window;
  Trajectory motion;
  motion.commands = placed(StreamRole::kCommands);
  motion.observations = placed(StreamRole::kObservations);
  window.trajectories.push_back(std::move(motion));
  StreamCheckOptions options = options_;
  checkFollowing(window, options, all);
  return all;
}

}  // namespace raven_correction
