// SPDX-License-Identifier: BSD-3-Clause
// What an operator needs of one arm, as buttons: record, retrain, switch the correction, go back;
// with progress, and the error before and after. Knows no rviz; as a panel of rviz it is
// session_panel.h.
#pragma once

#include <ros/ros.h>

#include <QWidget>
#include <functional>
#include <string>
#include <vector>

#include "raven_correction/CorrectionModel.h"
#include "raven_correction/CorrectionStatus.h"
#include "raven_correction/RecorderStatus.h"
#include "raven_correction/TrainingReport.h"
#include "raven_correction/WorkProgress.h"

class QComboBox;
class QLabel;
class QLineEdit;
class QProgressBar;
class QPushButton;

namespace raven_correction {

/// Messages arrive through the global callback queue, so whoever shows this widget spins it in the
/// thread of the window, as rviz does. Services are called in threads of their own: a retraining
/// takes its time, and the window stays alive.
class SessionControls : public QWidget {
  Q_OBJECT

 public:
  explicit SessionControls(QWidget* parent = nullptr);
  ~SessionControls() override = default;

  /// Namespace of the arm, e.g. "raven/left"; topics and services are those of robot.launch there.
  void setArm(const QString& arm);
  QString arm() const;

  /// Calls of all such widgets, also of those that are gone, whose answers have not been taken yet.
  static int unanswered();

 Q_SIGNALS:
  void armChanged();

 private:
  /// Answer of a service in a sentence.
  struct Answer {
    bool done = false;
    std::string words;
  };

  void connectArm();
  /// Calls in a thread of its own; buttons of that kind are off until the answer is there.
  void ask(QPushButton* button, const QString& what, std::function<Answer()> call);
  void say(const QString& words, bool good);
  void toggleRecording();
  void retrain();
  void rollBack();
  void setMode(int index);

  void onRecorder(const RecorderStatusConstPtr& message);
  void onProgress(const WorkProgressConstPtr& message);
  void onReport(const TrainingReportConstPtr& message);
  void onModel(const CorrectionModelConstPtr& message);
  void onStatus(const CorrectionStatusConstPtr& message);
  void watch();  // what has fallen silent

  QLineEdit* arm_;
  QPushButton* record_;
  QLabel* recorder_;
  QPushButton* retrain_;
  QPushButton* roll_back_;
  QProgressBar* progress_;
  QLabel* model_;
  QLabel* before_;
  QLabel* after_;
  QComboBox* mode_;
  QLabel* correction_;
  QLabel* said_;

  std::vector<ros::Subscriber> subscribers_;
  bool recording_ = false;
  ros::SteadyTime recorder_seen_, status_seen_;
};

}  // namespace raven_correction
