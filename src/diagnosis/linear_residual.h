// SPDX-License-Identifier: BSD-3-Clause
// The residual as a function of what the joints do, linear about one simulation: what moves joints
// moves the tool by its Jacobian. Derivatives by parameters are effect_fit.h.
#pragma once

#include <vector>

#include "raven_correction/diagnosis/residual.h"
#include "timeline.h"

namespace raven_correction {

class LinearResidual {
 public:
  /// @param here      none of its effects needs a load
  /// @param samples   what it says
  /// @param residual  that it leaves
  LinearResidual(const Recording& recording, const ResidualLayout& layout,
                 const SimulationConfig& here, const SimulatedSamples& samples,
                 const Eigen::VectorXd& residual);

  /// What changes when the joints do what they do in `there`. Thread-safe.
  /// @param there  made of `here` by withValues(); does not need a load; its links are not looked
  ///        at
  /// @return layout.size numbers
  Eigen::VectorXd changeTo(const SimulationConfig& there) const;

 private:
  const Recording& recording_;
  const ResidualLayout& layout_;
  const TracedHistory traced_;
  std::vector<Eigen::VectorXd> slopes_;  // of the poses by each joint; layout_.size each
};

}  // namespace raven_correction
