// SPDX-License-Identifier: BSD-3-Clause
// What the node `recorder` says about itself: its status and its diagnostics.
#include <cmath>

#include "raven_correction/error.h"
#include "raven_correction/ros/recorder.h"

namespace raven_correction {
namespace {

constexpr double kMegabyte = 1e6;      // [byte]
constexpr double kStatusPeriod = 1.0;  // [s]
constexpr double kSilence = 2.0;       // of a stream that is needed, before a warning [s]

}  // namespace

double Recorder::since(const ros::SteadyTime& then) {
  return (ros::SteadyTime::now() - then).toSec();
}

RecorderStatus Recorder::status() const {
  RecorderStatus status;
  status.header.stamp = ros::Time::now();
  status.state = RecorderStatus::IDLE;
  status.message = "idle";
  status.free_bytes = free_bytes_;
  if (writer_) {
    const SessionWriter::Progress progress = writer_->progress();
    if (progress.state == SessionWriter::State::kDiskFull)
      status.state = RecorderStatus::STOPPED_DISK_FULL;
    else if (progress.state == SessionWriter::State::kError)
      status.state = RecorderStatus::STOPPED_ERROR;
    else if (recording_)
      status.state = RecorderStatus::RECORDING;
    status.message = progress.message;
    status.bag = progress.bag;
    status.part = progress.part;
    status.bytes = progress.bytes;
    status.free_bytes = progress.free_bytes;
    status.dropped = progress.dropped;
  }
  for (const std::string& remark :
       {unregistered_message_, clock_message_, order_message_, delay_.message()})
    if (!remark.empty()) status.message += "; " + remark;
  status.trajectories = completed_trajectories_;
  status.pairs = pairs_;
  status.out_of_order = out_of_order_;
  for (const StreamFinding& finding : watch_->findings())
    status.findings.push_back(toText(finding));
  for (const StreamState& stream : streams_) {
    status.topics.push_back(stream.subscriber.getTopic());
    status.messages.push_back(stream.received);
  }
  return status;
}

void Recorder::publishStatus() {
  published_ = status();
  last_status_ = ros::SteadyTime::now();
  status_publisher_.publish(published_);
}

/// Each kind of finding once, so that the log is readable.
void Recorder::warnOfFindings() {
  std::set<std::string> now;
  for (const StreamFinding& finding : watch_->findings()) {
    const std::string kind = finding.stream + " " + finding.what;
    now.insert(kind);
    if (warned_of_.count(kind) == 0) ROS_WARN("recorder: %s", toText(finding).c_str());
  }
  warned_of_ = std::move(now);
}

void Recorder::onTimer() {
  warnOfFindings();
  watchClock(ros::Time::now());
  const bool delay_was_fine = delay_.message().empty();
  delay_.update();
  if (delay_was_fine && !delay_.message().empty())
    ROS_WARN("recorder: %s", delay_.message().c_str());
  const RecorderStatus now = status();
  const bool changed = now.state != published_.state || now.message != published_.message ||
                       now.bag != published_.bag || now.trajectories != published_.trajectories;
  const bool stopped = now.state != published_.state && now.state > RecorderStatus::RECORDING;
  if (stopped) ROS_ERROR("recorder: %s", now.message.c_str());
  if (changed || since(last_status_) >= kStatusPeriod) publishStatus();
  diagnostics_.update();
}

void Recorder::diagnose(diagnostic_updater::DiagnosticStatusWrapper& report) {
  using diagnostic_msgs::DiagnosticStatus;
  const RecorderStatus now = status();
  const bool running = now.state == RecorderStatus::RECORDING;
  report.summary(DiagnosticStatus::OK, running ? "recording" : "idle");
  if (now.state > RecorderStatus::RECORDING) report.summary(DiagnosticStatus::ERROR, now.message);
  if (now.dropped > 0) report.mergeSummary(DiagnosticStatus::WARN, "messages dropped");
  if (now.out_of_order > 0) report.mergeSummary(DiagnosticStatus::WARN, "stamps go back");
  if (!unregistered_message_.empty())
    report.mergeSummary(DiagnosticStatus::WARN, unregistered_message_);
  if (!delay_.message().empty()) report.mergeSummary(DiagnosticStatus::WARN, delay_.message());
  if (streams_[kCommand].subscriber.getNumPublishers() > 1)
    report.mergeSummary(DiagnosticStatus::WARN, "more than one node publishes servo_cp");

  for (std::size_t i = 0; i < now.findings.size(); ++i) {
    report.mergeSummary(DiagnosticStatus::WARN, now.findings[i]);
    report.add(format("finding %zu", i + 1), now.findings[i]);
  }

  const double interval = since(last_diagnosis_);
  last_diagnosis_ = ros::SteadyTime::now();
  for (StreamState& stream : streams_) {
    const double rate = static_cast<double>(stream.heard - stream.at_last_look) / interval;
    stream.at_last_look = stream.heard;
    const bool silent = stream.last.isZero() || since(stream.last) > kSilence;
    const bool needed = &stream == &streams_[kCommand] || &stream == &streams_[kMocap];
    if (running && needed && silent)
      report.mergeSummary(DiagnosticStatus::WARN, stream.topic + " is silent");
    report.addf(stream.topic + " rate [Hz]", "%.1f", rate);
    if (!stream.last.isZero()) report.addf(stream.topic + " age [s]", "%.3f", since(stream.last));
  }
  if (delay_.known()) report.addf("delay of motion capture [s]", "%.3f", delay_.delay());
  if (std::isfinite(delay_.modelDelay()))
    report.addf("delay of the model [s]", "%.3f", delay_.modelDelay());
  report.add("bag", now.bag);
  report.add("pairs", now.pairs);
  report.add("dropped", now.dropped);
  report.add("out of order", now.out_of_order);
  report.addf("free [MB]", "%.0f", static_cast<double>(now.free_bytes) / kMegabyte);
}

}  // namespace raven_correction
