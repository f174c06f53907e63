// SPDX-License-Identifier: BSD-3-Clause
// offline predict: F on a stream of desired poses, as the live corrector would compute it.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <limits>
#include <memory>

#include "raven_correction/correction/predictor.h"
#include "raven_correction/dataset/dataset_directory.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/model_file.h"
#include "raven_correction/ros/offline.h"

namespace raven_correction {
namespace {

struct Arguments {
  std::string model, states, output;
};

std::string refusal(MotionEstimator::Outcome outcome) {
  switch (outcome) {
    case MotionEstimator::Outcome::kBackwards:
      return "refused_time_backwards";
    case MotionEstimator::Outcome::kNotFinite:
      return "refused_not_finite";
    case MotionEstimator::Outcome::kNotUnit:
      return "refused_not_unit";
    case MotionEstimator::Outcome::kAccepted:
    case MotionEstimator::Outcome::kRepeated:
      break;
  }
  return {};
}

void appendRow(const std::string& trajectory, double stamp, const Pose& pose,
               const Eigen::Matrix<double, 6, 1>& sd, const std::string& status,
               std::string& text) {
  text += trajectory + format(",%.9f", stamp);
  for (const double value : {pose.p.x(), pose.p.y(), pose.p.z(), pose.q.x(), pose.q.y(), pose.q.z(),
                             pose.q.w(), sd(0), sd(1), sd(2), sd(3), sd(4), sd(5)})
    text += format(",%.17g", value);
  text += "," + status + "\n";
}

void predict(const Arguments& arguments) {
  checkOutputFile(arguments.output, false);
  const Predictor predictor(readModelFile(arguments.model));
  const Correction& model = predictor.model();
  const std::vector<NamedPoseStream> streams = readPoseCsv(arguments.states, PoseChecks::kNone);
  if (model.motion.velocity == VelocityKind::kCentral)
    std::fprintf(stderr,
                 "offline: this model was trained with the central stencil, which looks "
                 "ahead; predicting with the causal slope instead\n");
  const auto workspace = predictor.makeWorkspace();
  MotionEstimator estimator(model.motion);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Pose nowhere;
  nowhere.p.setConstant(kNan);
  nowhere.q.coeffs().setConstant(kNan);
  std::string text = "trajectory,stamp,x,y,z,qx,qy,qz,qw,sx,sy,sz,srx,sry,srz,status\n";
  std::size_t rows = 0, refused = 0;
  for (const NamedPoseStream& stream : streams) {
    estimator.startMotion();
    for (const StampedPose& state : stream.samples) {
      ++rows;
      const double stamp = state.stamp - model.delay;
      const MotionEstimator::Outcome outcome = estimator.push(state.stamp, state.pose);
      const std::string why = refusal(outcome);
      Eigen::Matrix<double, 6, 1> sd = Eigen::Matrix<double, 6, 1>::Constant(kNan);
      if (!why.empty()) {
        ++refused;
        appendRow(stream.trajectory, stamp, nowhere, sd, why, text);
        continue;
      }
      const Prediction prediction = predictor.predict(estimator.motion(), *workspace);
      sd << prediction.sd_position, prediction.sd_rotation;
      appendRow(stream.trajectory, stamp, prediction.command, sd,
                predictionStatusName(prediction.status), text);
    }
  }
  writeTextFile(arguments.output, text);
  std::printf("%s: %zu rows, %zu refused\n", arguments.output.c_str(), rows, refused);
}

}  // namespace

void addPredictCommand(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* const command = app.add_subcommand(
      "predict",
      "Commands for a stream of desired poses, from past samples only. One output row per input "
      "row; stamps are those for which the command is meant (state minus the model's delay). A row "
      "that repeats the stamp above is answered like it");
  command->add_option("--model", arguments->model, "model file")->required();
  command
      ->add_option("--states", arguments->states,
                   "CSV: trajectory,stamp,x,y,z,qx,qy,qz,qw (s, m, unit quaternion)")
      ->required();
  command->add_option("-o,--output", arguments->output, "CSV to write")->required();
  command->callback([arguments] { predict(*arguments); });
}

}  // namespace raven_correction
