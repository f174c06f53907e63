// SPDX-License-Identifier: BSD-3-Clause
// What the figures of a diagnosis are made from: both sides of a comparison, units of joints, rows
// of samples. The figures are diagnosis_figures.cpp and dependence_figures.cpp.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/diagnosis/diagnose.h"
#include "raven_correction/report/figure.h"

namespace raven_correction {

constexpr double kShown = 0.98;  ///< share of the points that an axis has room for [-]
constexpr char kBefore[] = "before (simulation as given)";
constexpr char kAfter[] = "after (all causes, motions held out)";
constexpr Ink kInkBefore = Ink::kVermilion, kInkAfter = Ink::kBlue;

/// The residual before or after, and how it is drawn.
struct Side {
  const ResidualSamples::Residual& residual;
  const char* title;
  Ink ink;
  bool before;
};
std::vector<Side> sidesOf(const Verdict& verdict);

/// One row, scaled; empty where there is no such row.
std::vector<double> rowOf(const Eigen::MatrixXd& values, Eigen::Index row, double scale);

/// Robots in mm and deg; joint data as they were given.
struct JointUnit {
  double scale;
  const char* name;
};
JointUnit unitOfJoint(const Verdict& verdict, std::size_t joint);

std::vector<Panel*> pointers(std::vector<Panel>& panels, std::size_t first, std::size_t count);

}  // namespace raven_correction
