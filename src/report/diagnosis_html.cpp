// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/diagnosis_html.h"

#include "diagnosis_advice.h"
#include "diagnosis_figures.h"
#include "diagnosis_words.h"
#include "health_html.h"
#include "raven_correction/diagnosis/separating_recording.h"
#include "raven_correction/error.h"
#include "report_json.h"

namespace raven_correction {
namespace {

constexpr char kPlusMinus[] = "\xC2\xB1";

std::string percentWithInterval(double value, double lower, double upper) {
  return format("%.1f %% (%.1f to %.1f %%)", kPercent * value, kPercent * lower, kPercent * upper);
}

std::string changeText(double before, double after, double scale, const char* unit) {
  return format("%.2f \xE2\x86\x92 %.2f %s", scale * before, scale * after, unit);
}

std::vector<std::string> findings(const Verdict& verdict) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < verdict.causes.size(); ++i) {
    const Cause& cause = verdict.causes[i];
    const std::size_t most = 5;
    if (i == most) {
      lines.push_back(format("and %zu smaller causes, see the table.", verdict.causes.size() - i));
      break;
    }
    const std::string meaning = adviceFor(cause.hypothesis.effect).meaning;
    lines.push_back(
        verdict.labels[i] + (meaning.empty() ? "" : " (" + meaning + ")") + " explains " +
        percentWithInterval(cause.share, cause.lower, cause.upper) +
        " of the held-out loss that is there without it" +
        (cause.equals.empty()
             ? "."
             : "; it cannot be told from " + joined(equalLabels(verdict, cause), "or") + " here."));
  }
  lines.push_back(unexplainedText(verdict));
  return lines;
}

/// "noise floor 0.12 mm (RMS)"; empty where no frames tell it.
std::string floorText(double floor, double scale, const char* unit) {
  return floor > 0.0 ? format("noise floor %.2f %s (RMS)", scale * floor, unit) : "";
}

std::vector<KeyNumber> keyNumbers(const Verdict& verdict) {
  std::vector<KeyNumber> numbers;
  const ErrorSizes& before = verdict.before.sizes;
  const ErrorSizes& after = verdict.after.sizes;
  if (verdict.has_kinematics) {
    numbers.push_back({"median position error",
                       changeText(before.position_median, after.position_median, kMillimetre, "mm"),
                       floorText(verdict.noise_floor, kMillimetre, "mm")});
    numbers.push_back({"95 % of position errors below",
                       changeText(before.position_p95, after.position_p95, kMillimetre, "mm"), ""});
    numbers.push_back(
        {"median orientation error",
         changeText(before.orientation_median, after.orientation_median, kDegree, "deg"),
         floorText(verdict.angle_floor, kDegree, "deg")});
  }
  numbers.push_back({verdict.has_kinematics ? "gain (position, RMS)" : "gain (RMS, mean of joints)",
                     format("%.1f %%", kPercent * verdict.gain),
                     format("95 %% interval %.1f to %.1f %%", kPercent * verdict.gain_lower,
                            kPercent * verdict.gain_upper)});
  if (verdict.aligned)
    numbers.push_back({"of it beyond registration and tool frame",
                       format("%.1f %%", kPercent * verdict.gain_from_alignment),
                       format("95 %% interval %.1f to %.1f %%", kPercent * verdict.alignment_lower,
                              kPercent * verdict.alignment_upper)});
  return numbers;
}

void appendRivals(const Verdict& verdict, HtmlDocument& document) {
  HtmlTable table;
  table.caption =
      "What this recording does not tell apart: what stands in the second column explains the "
      "held-out "
      "motions as well as the cause in the first, or better, when it takes its place and "
      "everything "
      "else is fitted again; of the two the simpler one is named. Log likelihood: of the held-out "
      "motions with the cause less with the other; expected: what that difference would be on "
      "average "
      "if the cause were the truth. Where as little as a few units are expected, no method could "
      "tell "
      "the two apart here.";
  table.header = {"cause",          "or",       "with parameters", "part of its gain",
                  "log likelihood", "expected", "to tell"};
  for (std::size_t i = 0; i < verdict.causes.size(); ++i) {
    const Cause& cause = verdict.causes[i];
    for (const Rival& rival : cause.equals) {
      std::vector<std::string> parameters;
      for (const NamedParameter& parameter : parametersOf(verdict, rival))
        parameters.push_back(parameterText(parameter, kPlusMinus));
      table.rows.push_back(
          {verdict.labels[i], hypothesisLabel(rival.hypothesis, verdict.simulation.robot),
           joined(parameters, "and"), format("%.0f %%", kPercent * rival.relative_gain),
           format("%+.2g", rival.log_likelihood), format("%.2g", rival.log_likelihood_expected),
           separatingRecording(cause.hypothesis.effect, rival.hypothesis.effect)});
    }
  }
  if (!table.rows.empty()) document.table(table);
}

void appendCauses(const Verdict& verdict, HtmlDocument& document) {
  document.section("Causes");
  if (verdict.causes.empty()) {
    document.paragraph(
        "None is claimed: no effect of the catalogue predicts motions that it was not fitted to "
        "better than chance.");
    return;
  }
  HtmlTable table;
  table.caption =
      "Explained: share of the held-out loss that is there without this cause and goes with it, "
      "with its 95 % interval over motions. The loss is squared and counts position and "
      "orientation "
      "alike, so a share of it is no share of the millimetres. Parameters with one standard "
      "deviation.";
  table.header = {"cause", "parameters", "explained", "cannot be told from", "next best"};
  for (std::size_t i = 0; i < verdict.causes.size(); ++i) {
    const Cause& cause = verdict.causes[i];
    std::vector<std::string> parameters;
    for (const NamedParameter& parameter : parametersOf(verdict, cause))
      parameters.push_back(parameterText(parameter, kPlusMinus));
    const std::string equal =
        cause.equals.empty() ? "-" : joined(equalLabels(verdict, cause), "or");
    table.rows.push_back({verdict.labels[i], joined(parameters, "and"),
                          percentWithInterval(cause.share, cause.lower, cause.upper), equal,
                          cause.has_runner_up
                              ? hypothesisLabel(cause.runner_up, verdict.simulation.robot) +
                                    format(" (%.0f %% of it)", kPercent * cause.runner_up_share)
                              : "-"});
  }
  document.table(table);
  appendRivals(verdict, document);
  document.figure(causesFigure(verdict));
  HtmlTable advice;
  advice.caption = "What each cause is, and what one can do about it at the robot.";
  advice.header = {"cause", "what it is", "what to do"};
  for (std::size_t i = 0; i < verdict.causes.size(); ++i) {
    const EffectAdvice words = adviceFor(verdict.causes[i].hypothesis.effect);
    advice.rows.push_back({verdict.labels[i], words.meaning, words.remedy});
  }
  document.table(advice);
}

void appendErrors(const Verdict& verdict, HtmlDocument& document) {
  document.section("How large the error is");
  HtmlTable table;
  table.caption =
      "Measured minus simulated. All causes: every motion predicted with parameters that were "
      "fitted without it. Last row: a Gaussian process has learnt from what the causes leave of "
      "the "
      "other motions.";
  const auto add = [&](const char* name, const DiagnosisErrors& errors) {
    const ErrorSizes& sizes = errors.sizes;
    std::vector<std::string> row{name};
    if (verdict.has_kinematics) {
      for (const double value : {sizes.position_rms, sizes.position_median, sizes.position_p95})
        row.push_back(format("%.2f", kMillimetre * value));
      for (const double value : {sizes.orientation_rms, sizes.orientation_median})
        row.push_back(format("%.2f", kDegree * value));
    } else {
      for (std::size_t j = 0; j < sizes.joint_rms.size(); ++j)
        row.push_back(format("%.3g / %.3g / %.3g", sizes.joint_rms[j], sizes.joint_median[j],
                             sizes.joint_p95[j]));
    }
    table.rows.push_back(row);
  };
  if (verdict.has_kinematics) {
    table.header = {"", "RMS [mm]", "median [mm]", "p95 [mm]", "RMS [deg]", "median [deg]"};
  } else {
    table.header = {""};
    for (std::size_t j = 0; j < verdict.joints.size(); ++j)
      table.header.push_back(verdict.joints[j] + " RMS / median / p95 [" + jointUnit(verdict, j) +
                             "]");
  }
  table.numeric.assign(table.header.size(), true);
  table.numeric[0] = false;
  add("simulation as given", verdict.before);
  if (verdict.aligned) add("registration and tool frame alone", verdict.after_alignment);
  add("all causes, motions held out", verdict.after);
  table.emphasised = {table.rows.size() - 1};
  add("and what a process learns from that", verdict.after_learning);
  document.table(table);
  document.figure(errorDistributionFigure(verdict));
  if (verdict.has_kinematics) {
    document.figure(foldsFigure(verdict));
    document.figure(toolAxesFigure(verdict));
  }
  document.figure(jointAxesFigure(verdict));
  if (verdict.has_kinematics) document.figure(workspaceFigure(verdict));
}

void appendDependence(const Verdict& verdict, HtmlDocument& document) {
  document.section("What it depends on");
  document.figure(dependenceFigure(verdict));
  document.figure(delayFigure(verdict));
  document.figure(jointFigure(verdict, JointVariable::kPosition));
  document.figure(jointFigure(verdict, JointVariable::kSpeed));
  if (verdict.figures.load.rows() > 0) document.figure(jointFigure(verdict, JointVariable::kLoad));
  document.figure(timeFigure(verdict));
}

void appendLeft(const Verdict& verdict, HtmlDocument& document) {
  document.section("What is left");
  document.note(verdict.unexplained ? Tone::kNotice : Tone::kGood, unexplainedText(verdict));
  document.paragraph(
      format("A linear regression on functions of all of these quantities together predicts %s of "
             "the squared residual after, on motions it has not learnt from: whether there is "
             "structure, and in what. Single wrong samples are clipped there, so it does not say "
             "how much smaller the error can become.",
             percentWithInterval(verdict.left.anything.share, verdict.left.anything.lower,
                                 verdict.left.anything.upper)
                 .c_str()));
  document.paragraph(format(
      "What a correction could learn on top of the physics: a Gaussian process with the "
      "features that it has live takes %s off the RMS %s that the causes leave, on motions "
      "held out. Near or below 0 %%: there is nothing for it to learn.",
      percentWithInterval(verdict.learnable, verdict.learnable_lower, verdict.learnable_upper)
          .c_str(),
      verdict.has_kinematics ? "of position" : "(mean of joints)"));
  if (verdict.has_kinematics && verdict.noise_floor > 0.0)
    document.paragraph(
        format("Noise floor, from one frame to the next, which no model can explain: %.2f mm and "
               "%.2f deg RMS.",
               kMillimetre * verdict.noise_floor, kDegree * verdict.angle_floor));
}

void appendHealth(const Verdict& verdict, const std::vector<StreamHealth>& streams,
                  HtmlDocument& document) {
  document.section("Data health");
  const Recording::Left& left = verdict.left_out;
  const auto count = [](std::size_t part, std::size_t all) {
    return format("%zu of %zu (%.1f %%)", part, all,
                  all == 0 ? 0.0 : kPercent * static_cast<double>(part) / static_cast<double>(all));
  };
  document.paragraph(
      format("%d motions, %zu samples used, %d folds; simulation driven by %s; "
             "encoders %s observed.",
             verdict.motions, verdict.samples, verdict.folds,
             verdict.source == DriveSource::kCommands ? "commands" : "encoders",
             verdict.has_encoders ? "are" : "are not"));
  HtmlTable table;
  table.caption = "Samples that were left out or changed, and why.";
  table.header = {"what", "samples", "meaning"};
  table.numeric = {false, true, false};
  table.rows = {
      {"commands that are no poses", count(left.not_a_command, left.setpoints),
       "not finite, no unit quaternion, or the identity that a controller sends before it knows "
       "better"},
      {"commands out of reach", count(left.unreachable, left.setpoints),
       "no joints of the nominal robot reproduce them: another robot file, frame or unit?"},
      {"commands outside joint limits", count(left.outside_limits, left.setpoints),
       "brought to the limit, as the controller does"},
      {"observations repeated", count(left.repeated, left.observations), "the frame before again"},
      {"observations impossible", count(left.impossible, left.observations),
       "not finite, or an orientation or speed that a tool cannot have"},
      {"observations thinned out", count(left.thinned, left.observations),
       "more than --max-samples; nothing is wrong with them"}};
  document.table(table);
  appendStreams(streams, document);
}

}  // namespace

std::string diagnosisHtml(const Verdict& verdict, const std::vector<StreamHealth>& streams,
                          const std::string& extended, const RunRecord& run) {
  HtmlDocument document("Diagnosis of " + verdict.recording,
                        "What the simulation gets wrong about this recording, why, and what it "
                        "gains to know.");
  const Headline headline = headlineOf(verdict);
  document.verdict(headline.tone, headline.text, findings(verdict), nextSteps(verdict, extended));
  document.keyNumbers(keyNumbers(verdict));
  appendCauses(verdict, document);
  appendErrors(verdict, document);
  appendDependence(verdict, document);
  appendLeft(verdict, document);
  appendHealth(verdict, streams, document);
  RunRecord record = run;
  record.settings.emplace_back("hypotheses and starts",
                               format("%zu, %zu", verdict.hypotheses, verdict.starts));
  record.settings.emplace_back("seed",
                               format("%llu", static_cast<unsigned long long>(verdict.seed)));
  record.settings.emplace_back("duration", format("%.1f s", verdict.seconds));
  appendProvenance(record, document);
  return document.text();
}

}  // namespace raven_correction
