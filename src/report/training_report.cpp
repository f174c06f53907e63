// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/training_report.h"

#include "raven_correction/error.h"
#include "report_json.h"

namespace raven_correction {
namespace {

std::string normsText(const char* what, const ErrorSummary& errors) {
  return format("%s %.2f mm, %.2f deg", what, kMillimetre * errors.position_norm,
                kDegree * errors.angle_norm);
}

Json errorsJson(const ErrorSummary& errors) {
  return {{"position_norm_mm", kMillimetre * errors.position_norm},
          {"position_median_mm", kMillimetre * errors.position_median},
          {"position_p95_mm", kMillimetre * errors.position_p95},
          {"angle_norm_deg", kDegree * errors.angle_norm},
          {"angle_mean_deg", kDegree * errors.angle_mean}};
}

Json heldOutJson(const TrainingPage& page) {
  const ErrorSummary full = summarise(page.held_out.full);
  Json json = {{"judged", page.judged},
               {"n", full.n},
               {"none", errorsJson(summarise(page.held_out.none))},
               {"rigid", errorsJson(summarise(page.held_out.rigid))},
               {"full", errorsJson(full)}};
  json["coverage95"] =
      std::vector<double>(full.coverage95.data(), full.coverage95.data() + full.coverage95.size());
  return json;
}

Json coverageJson(const WorkspaceCoverage& coverage) {
  Json json = {{"cell_mm", kMillimetre * coverage.cell},
               {"cells", coverage.cells.size()},
               {"covered", coverage.covered},
               {"record_more", Json::array()}};
  for (const CoverageCell& cell : coverage.record_more)
    json["record_more"].push_back({{"x_mm", kMillimetre * cell.centre.x()},
                                   {"y_mm", kMillimetre * cell.centre.y()},
                                   {"z_mm", kMillimetre * cell.centre.z()},
                                   {"commands", cell.commands},
                                   {"kept", cell.kept},
                                   {"trajectories", cell.trajectories}});
  return json;
}

}  // namespace

bool isJudgedFairly(const TrainingResult& result, const TrainingPage& page) {
  return result.simulation.empty() || (page.overlap && page.overlap->independent());
}

std::string physicsCaveat(const TrainingResult& result, const TrainingPage& page) {
  if (result.simulation.empty()) return "";
  if (isJudgedFairly(result, page))
    return format(
        "The simulation %s, which comes before the process, was fitted to none of these %zu "
        "trajectories either.",
        result.simulation.c_str(), page.overlap->of);
  if (page.overlap && page.overlap->known)
    return format(
        "The simulation %s, which comes before the process, was fitted to %zu of these %zu "
        "trajectories: there the errors flatter it (diagnose --hold-out leaves the same ones out).",
        result.simulation.c_str(), page.overlap->seen, page.overlap->of);
  return format(
      "The simulation %s comes before the process: these errors are of trajectories not seen only "
      "if it was not diagnosed from them (diagnose --hold-out leaves the same ones out).",
      result.simulation.c_str());
}

std::string trainingText(const TrainingResult& result, const TrainingPage* page) {
  std::string text;
  text += format("observations  %zu in all, %s\n", result.fates.total(),
                 describe(result.fates).c_str());
  text += format("commands      %zu identity poses removed\n", result.identity_commands);
  text += format("learnt from   %zu pairs of %zu trajectories\n", result.model.training_pairs,
                 result.model.training_trajectories);
  text += format("delay         %.4f s, %s\n", result.model.delay,
                 delayStatusText(result.delay.status));
  text += format("rigid step    leaves %.2f mm, %.2f deg (RMS on those pairs)\n",
                 kMillimetre * result.rigid_rms_position, kDegree * result.rigid_rms_angle);
  if (!result.simulation.empty())
    text += format("physics       %s leaves %.2f mm, %.2f deg (RMS); %zu pairs out of its reach\n",
                   result.simulation.c_str(), kMillimetre * result.physics_rms_position,
                   kDegree * result.physics_rms_angle, result.out_of_reach);
  static const char* const kOutputs[] = {"dx", "dy", "dz", "rx", "ry", "rz"};
  for (std::size_t g = 0; g < result.model.process.groups.size(); ++g) {
    const GpGroup& group = result.model.process.groups[g];
    for (std::size_t k = 0; k < group.outputs.size(); ++k) {
      const int output = group.outputs[k];
      const auto index = static_cast<Eigen::Index>(k);
      const double unit = output < 3 ? kMillimetre : kDegree;
      text +=
          format("process %s    signal %.2f, noise %.2f %s; %s\n", kOutputs[output],
                 unit * std::sqrt(group.signal_variance(index)),
                 unit * std::sqrt(group.noise_variance(index)), output < 3 ? "mm" : "deg",
                 g < result.process.groups.size() ? result.process.groups[g].message.c_str() : "");
    }
  }
  if (!result.model.process.groups.empty())
    text += format(
        "process       %.1f s for hyper-parameters, %.1f s for the posterior on %d "
        "pairs\n",
        result.process.seconds_hyperparameters, result.process.seconds_posterior,
        result.process.rows_used);
  if (page == nullptr) return text;
  const ErrorSummary full = summarise(page->held_out.full);
  text += format("held out      %zu states: %s; %s; %s (norms of the mean absolute errors)\n",
                 full.n, normsText("no correction", summarise(page->held_out.none)).c_str(),
                 normsText("rigid step", summarise(page->held_out.rigid)).c_str(),
                 normsText("all steps", full).c_str());
  text += "              " + page->judged + "\n";
  if (!result.simulation.empty()) text += "              " + physicsCaveat(result, *page) + "\n";
  text += format("coverage      %zu of %zu places that the robot was sent to\n",
                 page->coverage.covered, page->coverage.cells.size());
  return text;
}

std::string trainingJson(const TrainingResult& result, const std::string& model_file,
                         const TrainingPage* page) {
  Json json;
  json["model"] = model_file;
  json["id"] = result.model.id;
  json["delay_s"] = result.model.delay;
  json["cleaning"] = cleaningJson(result.fates, result.identity_commands);
  json["cleaning"]["least_median_scale_mm"] = kMillimetre * result.least_median_scale;
  json["rigid"] = {{"rms_position_mm", kMillimetre * result.rigid_rms_position},
                   {"rms_angle_deg", kDegree * result.rigid_rms_angle}};
  if (!result.simulation.empty())
    json["physics"] = {{"simulation", result.simulation},
                       {"rms_position_mm", kMillimetre * result.physics_rms_position},
                       {"rms_angle_deg", kDegree * result.physics_rms_angle},
                       {"out_of_reach", result.out_of_reach}};
  json["n_train"] = result.model.training_pairs;
  json["trajectories"] = result.model.training_trajectories;
  Json groups = Json::array();
  for (std::size_t g = 0; g < result.model.process.groups.size(); ++g) {
    const GpGroup& group = result.model.process.groups[g];
    Json entry;
    entry["outputs"] = group.outputs;
    if (g < result.process.groups.size()) {
      entry["log_marginal_likelihood"] = result.process.groups[g].log_marginal_likelihood;
      entry["converged"] = result.process.groups[g].converged;
      entry["message"] = result.process.groups[g].message;
    }
    const auto list = [](const Eigen::VectorXd& values) {
      return std::vector<double>(values.data(), values.data() + values.size());
    };
    entry["signal_sd"] = list(group.signal_variance.cwiseSqrt());
    entry["noise_sd"] = list(group.noise_variance.cwiseSqrt());
    entry["length_scales"] = list(group.length_scales);
    groups.push_back(entry);
  }
  json["process"] = {{"rows", result.process.rows},
                     {"rows_used", result.process.rows_used},
                     {"seconds_hyperparameters", result.process.seconds_hyperparameters},
                     {"seconds_posterior", result.process.seconds_posterior},
                     {"groups", groups}};
  if (page != nullptr) {
    json["held_out"] = heldOutJson(*page);
    json["coverage"] = coverageJson(page->coverage);
  }
  return json.dump(1) + "\n";
}

}  // namespace raven_correction
