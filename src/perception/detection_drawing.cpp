// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/perception/detection_drawing.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

namespace raven_correction {
namespace {

// Black under white is seen on red, on tissue and on a drape, and by everybody.
const cv::Scalar kDark(0, 0, 0);
const cv::Scalar kLight(255, 255, 255);
constexpr std::size_t kDash = 6;  // [px]

void drawLine(cv::Mat& image, cv::Point a, cv::Point b) {
  cv::line(image, a, b, kDark, 3, cv::LINE_AA);
  cv::line(image, a, b, kLight, 1, cv::LINE_AA);
}

}  // namespace

void drawDetections(const std::vector<FragmentDetection>& detections, cv::Mat& image) {
  int number = 0;
  for (const FragmentDetection& detection : detections) {
    for (std::size_t i = 0; i < detection.outline.size(); ++i) {
      if (detection.partly_hidden && (i / kDash) % 2 == 1) continue;
      cv::line(image, detection.outline[i], detection.outline[(i + 1) % detection.outline.size()],
               kLight, 1, cv::LINE_AA);
    }
    const cv::Point centre(static_cast<int>(std::lround(detection.pixel.u_left)),
                           static_cast<int>(std::lround(detection.pixel.v)));
    const cv::Point2d along = detection.axis;
    drawLine(image, centre - cv::Point(along), centre + cv::Point(along));
    cv::circle(image, centre, 3, kDark, cv::FILLED, cv::LINE_AA);
    cv::circle(image, centre, 2, kLight, cv::FILLED, cv::LINE_AA);
    const std::string text = std::to_string(++number);
    const cv::Point beside = centre + cv::Point(5, -5);
    cv::putText(image, text, beside, cv::FONT_HERSHEY_SIMPLEX, 0.5, kDark, 3, cv::LINE_AA);
    cv::putText(image, text, beside, cv::FONT_HERSHEY_SIMPLEX, 0.5, kLight, 1, cv::LINE_AA);
  }
}

void drawPieces(const cv::Mat& labels, cv::Mat& image) {
  // Okabe and Ito's colours, as blue green red: told apart by colour-blind people, too.
  const cv::Vec3b colours[] = {{0, 159, 230}, {233, 180, 86}, {115, 158, 0},  {66, 228, 240},
                               {178, 114, 0}, {0, 94, 213},   {167, 121, 204}};
  constexpr int kColours = 7;
  for (int v = 0; v < labels.rows; ++v)
    for (int u = 0; u < labels.cols; ++u) {
      const int label = labels.at<int>(v, u);
      if (label == 0) continue;
      cv::Vec3b& pixel = image.at<cv::Vec3b>(v, u);
      const cv::Vec3b& colour = colours[label % kColours];
      for (int c = 0; c < 3; ++c)
        pixel[c] = static_cast<std::uint8_t>((pixel[c] + 2 * colour[c]) / 3);
    }
}

}  // namespace raven_correction
