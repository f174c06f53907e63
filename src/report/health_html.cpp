// SPDX-License-Identifier: BSD-3-Clause
#include "health_html.h"

#include "raven_correction/error.h"
#include "report_json.h"

namespace raven_correction {
namespace {

constexpr double kManyGaps = 0.05;      // of the duration [-]
constexpr double kManyRepeated = 0.05;  // of the samples [-]

std::string share(std::size_t part, std::size_t all) {
  if (all == 0) return "0";
  return format("%zu (%.1f %%)", part,
                kPercent * static_cast<double>(part) / static_cast<double>(all));
}

/// What a reason of rejection means, and what to do about it.
const char* meaningOf(Fate fate) {
  switch (fate) {
    case Fate::kKept:
      return "learnt from";
    case Fate::kNotFinite:
      return "a coordinate is no number: the tracker reports lost markers so";
    case Fate::kNotUnit:
      return "no rotation: look at the driver of the tracker";
    case Fate::kRepeated:
      return "the frame before again: the tracker held its last pose";
    case Fate::kNoCommand:
      return "before the first or after the last command of its trajectory";
    case Fate::kCommandGap:
      return "the commands around it are too far apart to know what was meant";
    case Fate::kLongStep:
      return "too long after the observation before it to take a velocity from";
    case Fate::kRotationWindow:
      return "an orientation in which the markers cannot be visible: markers taken for one another";
    case Fate::kWorkspace:
      return "outside the workspace of the commands";
    case Fate::kSpeed:
      return "faster than the robot can move: a jump of the tracker";
    case Fate::kAngularSpeed:
      return "turns faster than the robot can: a jump of the tracker";
    case Fate::kLeastMedian:
      return "far from the rigid model that explains most of the others";
    case Fate::kTrajectoryRejected:
      return "most of its trajectory was rejected, so all of it went";
    case Fate::kCount:
      break;
  }
  return "";
}

}  // namespace

void appendStreams(const std::vector<StreamHealth>& streams, HtmlDocument& document) {
  HtmlTable table;
  table.caption =
      "Streams as they were recorded. A gap is an interval of more than three median periods "
      "within "
      "a trajectory.";
  table.header = {"stream",           "trajectories",    "samples",
                  "seconds",          "rate [Hz]",       "95 % of intervals below [ms]",
                  "time in gaps [%]", "longest gap [s]", "repeated",
                  "not finite"};
  table.numeric = {false, true, true, true, true, true, true, true, true, true};
  for (const StreamHealth& stream : streams)
    table.rows.push_back(
        {stream.stream, std::to_string(stream.trajectories), std::to_string(stream.samples),
         format("%.1f", stream.duration),
         stream.period_median > 0.0 ? format("%.1f", 1.0 / stream.period_median) : "n/a",
         format("%.1f", 1e3 * stream.period_p95), format("%.1f", kPercent * stream.gap_share),
         format("%.2f", stream.longest_gap), share(stream.repeated, stream.samples),
         std::to_string(stream.not_finite)});
  document.table(table);
  for (const StreamHealth& stream : streams) {
    if (stream.gap_share > kManyGaps)
      document.note(Tone::kWarning,
                    format("%s: %.0f %% of the time lies in gaps, the longest (%.2f s) in "
                           "trajectory %s. Look for lost sight, a full disk or a slow network.",
                           stream.stream.c_str(), kPercent * stream.gap_share, stream.longest_gap,
                           stream.longest_in.c_str()));
    if (static_cast<double>(stream.repeated) > kManyRepeated * static_cast<double>(stream.samples))
      document.note(Tone::kNotice,
                    format("%s: %s of the samples repeat the one before; the stream is slower than "
                           "its rate says.",
                           stream.stream.c_str(), share(stream.repeated, stream.samples).c_str()));
  }
}

void appendFindings(const std::vector<StreamFinding>& findings, HtmlDocument& document) {
  for (const StreamFinding& finding : findings) document.note(Tone::kWarning, toText(finding));
  if (findings.empty())
    document.paragraph(
        "Checked and found in order: stamps, rates, frames, units, arm, clocks, and that what was "
        "seen follows what was commanded.");
}

void appendFates(const FateCounts& fates, std::size_t identity_commands, HtmlDocument& document) {
  HtmlTable table;
  table.caption = "What became of every observation; the first reason that applies counts.";
  table.header = {"fate", "observations", "meaning"};
  table.numeric = {false, true, false};
  for (std::size_t i = 0; i < fates.count.size(); ++i) {
    if (i > 0 && fates.count[i] == 0) continue;
    const Fate fate = static_cast<Fate>(i);
    table.rows.push_back({fateName(fate), share(fates.count[i], fates.total()), meaningOf(fate)});
  }
  document.table(table);
  document.paragraph(
      format("%zu commands were identity poses and were removed.", identity_commands));
}

}  // namespace raven_correction
