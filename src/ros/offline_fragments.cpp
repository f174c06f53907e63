// SPDX-License-Identifier: BSD-3-Clause
// offline experiment fragments: how many foam fragments the stereo camera finds in rendered scenes,
// how exactly, and whether the covariance is right. Needs no ROS master.
#include <CLI/CLI.hpp>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "raven_correction/error.h"
#include "raven_correction/evaluation/fragment_trial.h"
#include "raven_correction/perception/detection_drawing.h"
#include "raven_correction/report/fragment_report.h"
#include "raven_correction/ros/offline.h"

namespace raven_correction {
namespace {

struct Arguments {
  FragmentTrial trial;
  std::string picture;
  NumberFiles numbers;
};

/// The first scene of the trial with what was found in it: both raw images above, below them the
/// rectified left one with the detections and the pieces of foam in colours.
void writePicture(FragmentTrial trial, const std::string& file) {
  trial.empty_every = 0;
  FragmentTrialScene scene = renderTrialScene(trial, 0);
  const auto asMat = [](ColourImage& image) {
    return cv::Mat(image.height, image.width, CV_8UC3, image.bgr.data());
  };
  cv::Mat left = asMat(scene.picture.left);
  cv::Mat right = asMat(scene.picture.right);
  FragmentDetectorTrace trace;
  const FragmentDetector detector(scene.rig.camera, scene.rig.X_field_camera, trial.detector);
  drawDetections(detector.detect(left, right, &trace), trace.left);
  cv::Mat pieces = trace.right.clone();
  drawPieces(trace.right_labels, pieces);
  cv::Mat rows[2];
  cv::hconcat(left, right, rows[0]);
  cv::hconcat(trace.left, pieces, rows[1]);
  cv::Mat all;
  cv::vconcat(rows, 2, all);
  if (!cv::imwrite(file, all)) throw InvalidInput(format("%s: cannot be written", file.c_str()));
}

void run(const Arguments& arguments) {
  checkNumberFiles(arguments.numbers);
  checkOutputFile(arguments.picture, true);
  if (!arguments.picture.empty() && arguments.picture.rfind(".png") == std::string::npos)
    throw InvalidInput(format("%s: a picture has to end in .png", arguments.picture.c_str()));
  const int scenes = arguments.trial.scenes;
  const FragmentScore score = runFragmentTrial(arguments.trial, [scenes](int k) {
    showProgress("rendering and looking", (k + 1.0) / scenes);
  });
  std::fputs(fragmentText(score).c_str(), stdout);
  writeNumbers(arguments.numbers, fragmentJson(score));
  if (!arguments.picture.empty()) writePicture(arguments.trial, arguments.picture);
}

}  // namespace

void addFragmentsExperiment(CLI::App& experiment) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* const command = experiment.add_subcommand(
      "fragments",
      "Renders fields of foam fragments as a stereo camera sees them, looks for the fragments, and "
      "counts what was found, how exactly, and whether the predicted covariance is right");
  command->add_option("--scenes", arguments->trial.scenes, "number of scenes; default 200")
      ->check(CLI::Range(1, 100000));
  command->add_option("--seed", arguments->trial.seed, "of the first scene; default 1");
  command
      ->add_option("--neighbours", arguments->trial.scene.neighbour_share,
                   "share of fragments laid against or onto another; default 0.4")
      ->check(CLI::Range(0.0, 1.0));
  addNumberOptions(*command, arguments->numbers);
  command->add_option("--picture", arguments->picture,
                      "write the first scene with its detections (PNG)");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace raven_correction
