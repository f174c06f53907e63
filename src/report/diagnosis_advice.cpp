// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis_advice.h"

#include <array>

#include "diagnosis_words.h"
#include "raven_correction/diagnosis/separating_recording.h"
#include "raven_correction/error.h"
#include "report_json.h"

namespace raven_correction {
namespace {

struct Entry {
  const char* effect;
  const char* meaning;
  const char* remedy;
};

constexpr Entry kEntries[] = {
    {"command_delay", "commands act later than they are sent",
     "look for queues and slow loops between planner and controller; what cannot be removed, the "
     "planner can send earlier by this time"},
    {"tracking_lag", "the drive follows its set-point like a filter",
     "raise the gains of this joint's controller, or plan slower motions of it"},
    {"drive_friction", "the motor stops short of its set-point, on the side it came from",
     "lubricate or raise the stiffness of the controller (an integral part removes it); approach "
     "targets from one side"},
    {"speed_limit", "the joint cannot move faster than this",
     "let the planner keep below this speed"},
    {"motor_saturation",
     "a motor that has to turn with other joints does not keep up, and drags the tool along",
     "plan slower motions of the joints that its motor has to follow"},
    {"joint_offset", "the joint was homed at a wrong angle",
     "home it again, or enter the offset in the robot's file"},
    {"joint_gain", "the transmission ratio that the controller believes is wrong",
     "enter the ratio in the robot's file; look at the capstan's diameter"},
    {"joint_coupling", "motion of one joint moves another",
     "enter the coupling in the robot's file"},
    {"backlash", "play between motor and joint",
     "tension this joint's cable; approach targets from one side"},
    {"cable_stretch", "the joint gives way under its load",
     "tension the cable; enter the stiffness where payloads change"},
    {"pulley_eccentricity", "a pulley runs out of round",
     "look at the pulleys with this period; a correction learnt from data removes the rest"},
    {"creep", "the joint drifts over the session",
     "warm the robot up before work; home again after this time"},
    {"link_geometry", "a link's length or angle differs from the robot's file",
     "enter it in the robot's file"},
    {"base_registration", "the robot's base is not where the registration says",
     "register the tracker to the base again, or correct the registration by these numbers"},
    {"tool_offset", "the markers sit elsewhere on the tool than the file says",
     "enter the offset of the marker frame; nothing is wrong with the robot"},
    {"registration_shift", "the base or the cameras were moved during the recording",
     "register again after this instant; learn from one side of it only"},
    {"mocap_scale", "the tracker's positions are scaled", "calibrate the tracker"},
};

constexpr double kManyLeft = 0.1;  // share of samples left out that is worth a look [-]
constexpr int kFewMotions = 20;    // held-out intervals of fewer motions are wide

bool needsLook(const Verdict& verdict) {
  const Recording::Left& left = verdict.left_out;
  const auto share = [](std::size_t part, std::size_t all) {
    return all == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(all);
  };
  return share(left.not_a_command + left.unreachable + left.outside_limits, left.setpoints) >
             kManyLeft ||
         share(left.impossible, left.observations) > kManyLeft;
}

}  // namespace

EffectAdvice adviceFor(const std::string& effect) {
  for (const Entry& entry : kEntries)
    if (effect == entry.effect) return {entry.meaning, entry.remedy};
  return {};
}

std::vector<std::string> nextSteps(const Verdict& verdict, const std::string& extended) {
  std::vector<std::string> steps;
  const std::size_t most = 3;  // causes with an advice of their own; the table has them all
  for (std::size_t i = 0; i < std::min(most, verdict.causes.size()); ++i) {
    const std::string remedy = adviceFor(verdict.causes[i].hypothesis.effect).remedy;
    if (!remedy.empty()) steps.push_back(verdict.labels[i] + ": " + remedy + ".");
  }
  for (std::size_t i = 0; i < verdict.causes.size(); ++i) {
    const Cause& cause = verdict.causes[i];
    if (cause.equals.empty()) continue;
    steps.push_back(
        "To tell " + verdict.labels[i] + " from " + joined(equalLabels(verdict, cause), "and") +
        ": " +
        separatingRecording(cause.hypothesis.effect, cause.equals.front().hypothesis.effect) + ".");
  }
  if (!verdict.causes.empty() && verdict.has_kinematics)
    steps.push_back(
        extended.empty()
            ? std::string("Write the extended simulation with -o extended.yaml, and use it "
                          "instead of the one that was given.")
            : "Use the extended simulation, " + extended + ", instead of the one that was given.");
  if (verdict.unexplained)
    steps.push_back(
        verdict.predicted
            ? "What is left can partly be predicted: let a correction learn it (train), "
              "and look below at what it depends on; the physics may be missing in the "
              "catalogue."
            : "What is left is larger than the noise, and nothing tried here predicts "
              "it: look for what changes from motion to motion (a table that gives "
              "way, markers that are lost, a cable that slips).");
  if (!verdict.converged)
    steps.push_back(
        "The last fit did not converge: do not rely on the parameters; record more "
        "motions, or start from a simulation that is nearer.");
  if (verdict.stopped_at_most)
    steps.push_back(
        "The search ended because as many causes were in as it may find: raise --max-causes to see "
        "whether there are more.");
  if (needsLook(verdict))
    steps.push_back("More than a tenth of the samples was left out: see \"Data health\" first.");
  if (verdict.motions < kFewMotions)
    steps.push_back(format("Only %d motions: record more of them, so that intervals become narrow.",
                           verdict.motions));
  if (steps.empty()) steps.emplace_back("Nothing: the simulation explains this recording.");
  return steps;
}

Headline headlineOf(const Verdict& verdict) {
  Headline headline;
  const std::string gain = format("%.1f %% (%.1f to %.1f %%)", kPercent * verdict.gain,
                                  kPercent * verdict.gain_lower, kPercent * verdict.gain_upper);
  if (verdict.causes.empty()) {
    headline.tone = verdict.unexplained ? Tone::kWarning : Tone::kGood;
    headline.text = verdict.unexplained
                        ? "No known cause explains what the simulation gets wrong."
                        : "The simulation explains this recording; nothing is claimed.";
    return headline;
  }
  headline.text = verdict.causes.size() == 1
                      ? "One cause, " + verdict.labels[0] + ", removes " + gain + " of the error"
                      : format("%zu causes, %s first, remove ", verdict.causes.size(),
                               verdict.labels[0].c_str()) +
                            gain + " of the error";
  if (verdict.has_kinematics)
    headline.text +=
        format(": %.2f mm become %.2f mm (RMS)", kMillimetre * verdict.before.sizes.position_rms,
               kMillimetre * verdict.after.sizes.position_rms);
  headline.text +=
      ", on motions that the parameters were not fitted to. The causes were chosen with all "
      "motions "
      "in view, so this is slightly optimistic where there are many weak ones.";
  headline.tone = verdict.unexplained || !verdict.converged ? Tone::kNotice : Tone::kGood;
  return headline;
}

}  // namespace raven_correction
