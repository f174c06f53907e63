// SPDX-License-Identifier: BSD-3-Clause
// Does the panel of rviz say what the nodes say, and do its buttons what they are called?
#include <gtest/gtest.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <ros/spinner.h>

#include <QApplication>
#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QProgressBar>
#include <QPushButton>
#include <atomic>

#include "panel/session_controls.h"
#include "raven_correction/Retrain.h"
#include "raven_correction/SetMode.h"
#include "support/node_main.h"
#include "support/wait_for.h"

namespace raven_correction {
namespace {

constexpr double kLimit = 20.0;  // [s]

class Panel : public testing::Test {
 protected:
  Panel() : controls_(new SessionControls) { controls_->setArm("arm"); }

  template <typename Widget>
  Widget* find(const char* name) {
    return controls_->findChild<Widget*>(name);
  }
  QString text(const char* label) { return find<QLabel>(label)->text(); }
  template <typename Condition>
  bool until(Condition condition) {
    return waitFor(
        [&] {
          ros::spinOnce();
          QApplication::processEvents();
          return condition();
        },
        kLimit);
  }

  std::unique_ptr<SessionControls> controls_;
};

TEST_F(Panel, StartsAndStopsARecording) {
  QPushButton* const button = find<QPushButton>("record");
  ASSERT_TRUE(until([&] { return !text("recorder").contains("silent"); }));
  EXPECT_EQ(button->text(), "Start recording");
  button->click();
  EXPECT_FALSE(button->isEnabled());  // no second start while the first is not answered
  ASSERT_TRUE(until([&] { return button->text() == "Stop recording"; }))
      << text("said").toStdString();
  ASSERT_TRUE(until([&] { return text("recorder").startsWith("recording: 0 motions"); }));
  ASSERT_TRUE(until([&] { return button->isEnabled(); }));
  button->click();
  ASSERT_TRUE(until([&] { return button->text() == "Start recording"; }))
      << text("said").toStdString();
}

TEST_F(Panel, SaysWhyNothingHappened) {
  find<QPushButton>("roll_back")->click();
  ASSERT_TRUE(until([&] { return text("said").startsWith("Failed: "); }));
  EXPECT_TRUE(text("said").contains("/arm/trainer/rollback does not answer"));
  EXPECT_TRUE(find<QPushButton>("roll_back")->isEnabled());
  controls_->setArm("no name!");
  EXPECT_TRUE(text("said").contains("no name"));
}

TEST_F(Panel, ShowsProgressAndTheErrorBeforeAndAfter) {
  ros::NodeHandle nh("/arm");
  auto progress = nh.advertise<WorkProgress>("trainer/progress", 1, true);
  auto report = nh.advertise<TrainingReport>("trainer/report", 1, true);
  auto model = nh.advertise<CorrectionModel>("correction/model", 1, true);
  WorkProgress running;
  running.state = WorkProgress::RUNNING;
  running.phase = "fitting";
  running.fraction = 0.42;
  running.time_left = 3.0;
  progress.publish(running);
  ASSERT_TRUE(until([&] { return find<QProgressBar>("progress")->value() == 420; }));
  EXPECT_TRUE(find<QProgressBar>("progress")->format().startsWith("fitting, 3 s left"));

  TrainingReport done;
  done.success = true;
  done.live = true;
  done.none_position = {0.003, 0.004, 0.0};
  done.none_angle = {0.1, 0.0, 0.0};
  done.full_position = {0.001, 0.0, 0.0};
  done.full_angle = {0.0, 0.01, 0.0};
  report.publish(done);
  CorrectionModel trained;
  trained.id = "model-7";
  trained.training_pairs = 1234;
  model.publish(trained);
  ASSERT_TRUE(until([&] { return text("model").startsWith("model-7") && text("after") != "-"; }));
  EXPECT_EQ(text("before"), "5.00 mm   5.73 deg");
  EXPECT_EQ(text("after"), "1.00 mm   0.57 deg");
}

TEST_F(Panel, SwitchesTheModeAndShowsWhatTheCorrectorDoes) {
  ros::NodeHandle nh("/arm");
  std::string asked;
  const ros::ServiceServer server = nh.advertiseService<SetMode::Request, SetMode::Response>(
      "corrector/set_mode", [&](SetMode::Request& request, SetMode::Response& response) {
        asked = request.mode;
        response.success = true;
        response.message = "done";
        return true;
      });
  QComboBox* const mode = find<QComboBox>("mode");
  mode->setCurrentIndex(mode->findText("full"));
  Q_EMIT mode->activated(mode->findText("full"));  // as a user's choice does
  ASSERT_TRUE(until([&] { return text("said") == "done"; }));
  EXPECT_EQ(asked, "full");
  auto status = nh.advertise<CorrectionStatus>("correction/status", 1);
  CorrectionStatus said;
  said.mode = "rigid";
  said.code = CorrectionStatus::RIGID_ONLY;
  ASSERT_TRUE(until([&] {
    status.publish(said);
    return text("correction") == "rigid only";
  }));
  EXPECT_EQ(mode->currentText(), "rigid");
}

TEST_F(Panel, MayBeClosedWhileATrainingRuns) {
  ros::NodeHandle nh("/arm");
  std::atomic<bool> called{false}, go_on{false};
  ros::CallbackQueue
      queue;  // another node's: it answers while the window's thread does other things
  nh.setCallbackQueue(&queue);
  const ros::ServiceServer server = nh.advertiseService<Retrain::Request, Retrain::Response>(
      "trainer/retrain", [&](Retrain::Request& /*request*/, Retrain::Response& response) {
        called = true;
        waitFor([&] { return go_on.load(); }, kLimit);
        response.success = true;
        return true;
      });
  ros::AsyncSpinner spinner(1, &queue);
  spinner.start();
  find<QPushButton>("retrain")->click();
  ASSERT_TRUE(until([&] { return called.load(); }));
  EXPECT_TRUE(text("said").startsWith("training"));  // and the window answers meanwhile
  controls_.reset();
  go_on = true;
  ASSERT_TRUE(until([] { return SessionControls::unanswered() == 0; }));  // and finds nobody
  spinner.stop();
}

}  // namespace
}  // namespace raven_correction

int main(int argc, char** argv) {
  QApplication application(argc, argv);
  return raven_correction::runNodeTests(argc, argv, "test_panel");
}
