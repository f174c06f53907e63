// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/training_report.h"

#include "raven_correction/error.h"
#include "report_json.h"

namespace raven_correction {
std::string trainingText(const TrainingResult& result) {
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
  return text;
}

std::string trainingJson(const TrainingResult& result, const std::string& model_file) {
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
  return json.dump(1) + "\n";
}

}  // namespace raven_correction
