// SPDX-License-Identifier: BSD-3-Clause
// SessionControls as a panel of rviz (Panels > Add New Panel > raven_correction/Session).
#pragma once

#include <rviz/panel.h>

namespace raven_correction {

class SessionControls;

class SessionPanel : public rviz::Panel {
  Q_OBJECT

 public:
  explicit SessionPanel(QWidget* parent = nullptr);

  /// Keeps the arm in the configuration of rviz (key Arm; without it the namespace of rviz).
  void load(const rviz::Config& config) override;
  void save(rviz::Config config) const override;

 private:
  SessionControls* controls_;
};

}  // namespace raven_correction
