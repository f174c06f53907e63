// SPDX-License-Identifier: BSD-3-Clause
#include "session_panel.h"

#include <QVBoxLayout>
#include <pluginlib/class_list_macros.hpp>

#include "session_controls.h"

namespace raven_correction {

SessionPanel::SessionPanel(QWidget* parent) : rviz::Panel(parent), controls_(new SessionControls) {
  auto* const layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(controls_);
  connect(controls_, &SessionControls::armChanged, this, [this] { Q_EMIT configChanged(); });
}

void SessionPanel::load(const rviz::Config& config) {
  rviz::Panel::load(config);
  QString arm;
  if (config.mapGetString("Arm", &arm)) controls_->setArm(arm);
}

void SessionPanel::save(rviz::Config config) const {
  rviz::Panel::save(config);
  config.mapSetValue("Arm", controls_->arm());
}

}  // namespace raven_correction

PLUGINLIB_EXPORT_CLASS(raven_correction::SessionPanel, rviz::Panel)
