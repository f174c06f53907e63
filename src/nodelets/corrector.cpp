// SPDX-License-Identifier: BSD-3-Clause
// The node `corrector` as a nodelet (ros/corrector_node.h); nodelets.xml declares it.
#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "raven_correction/ros/corrector_node.h"

namespace raven_correction {

class CorrectorNodelet : public nodelet::Nodelet {
 private:
  void onInit() override {
    node_ = std::make_unique<CorrectorNode>(getNodeHandle(), getPrivateNodeHandle());
  }

  std::unique_ptr<CorrectorNode> node_;
};

}  // namespace raven_correction

PLUGINLIB_EXPORT_CLASS(raven_correction::CorrectorNodelet, nodelet::Nodelet)
