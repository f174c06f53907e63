// SPDX-License-Identifier: BSD-3-Clause
#include "session_controls.h"

#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include <QAbstractItemView>
#include <QComboBox>
#include <QCoreApplication>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPointer>
#include <QProgressBar>
#include <QPushButton>
#include <QRegExp>
#include <QTimer>
#include <atomic>
#include <cmath>
#include <thread>

#include "raven_correction/Retrain.h"
#include "raven_correction/SetMode.h"
#include "raven_correction/StartRecording.h"
#include "raven_correction/StopRecording.h"
#include "raven_correction/correction/corrector_code.h"
#include "raven_correction/error.h"
#include "raven_correction/ros/topics.h"

namespace raven_correction {
namespace {

constexpr double kSilence = 3.0;  // after which a node is taken to be gone [s]
constexpr double kDegree = 180.0 / 3.14159265358979323846;
constexpr int kWatchPeriod = 500;  // [ms]

std::atomic<int> calls{0};  // without an answer yet

/// The namespace in which rviz was started; without one the arm of the demo.
QString ownNamespace() {
  const QString ns = QString::fromStdString(ros::this_node::getNamespace()).remove(QRegExp("^/+"));
  return ns.isEmpty() ? "raven/left" : ns;
}

std::string noAnswer(const std::string& service) {
  return service + " does not answer: is its node running, and is the arm's namespace right?";
}

template <typename Service>
bool call(const std::string& name, Service& service) {
  return ros::service::exists(name, false) && ros::service::call(name, service);
}

template <typename Array>
double normOf(const Array& values) {
  return std::sqrt(values[0] * values[0] + values[1] * values[1] + values[2] * values[2]);
}

template <typename Array>
QString errorWords(const Array& position, const Array& angle) {
  return QString::fromStdString(
      format("%.2f mm   %.2f deg", 1e3 * normOf(position), kDegree * normOf(angle)));
}

QLabel* wrapped() {
  auto* const label = new QLabel;
  label->setWordWrap(true);
  return label;
}

}  // namespace

SessionControls::SessionControls(QWidget* parent)
    : QWidget(parent),
      arm_(new QLineEdit(ownNamespace())),
      record_(new QPushButton("Start recording")),
      recorder_(wrapped()),
      retrain_(new QPushButton("Retrain")),
      roll_back_(new QPushButton("Roll back")),
      progress_(new QProgressBar),
      model_(wrapped()),
      before_(new QLabel("-")),
      after_(new QLabel("-")),
      mode_(new QComboBox),
      correction_(wrapped()),
      said_(wrapped()) {
  for (QWidget* const named :
       std::initializer_list<QWidget*>{arm_, record_, recorder_, retrain_, roll_back_, progress_,
                                       model_, before_, after_, mode_, correction_, said_})
    named->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Preferred);
  arm_->setObjectName("arm");
  record_->setObjectName("record");
  recorder_->setObjectName("recorder");
  retrain_->setObjectName("retrain");
  roll_back_->setObjectName("roll_back");
  progress_->setObjectName("progress");
  model_->setObjectName("model");
  before_->setObjectName("before");
  after_->setObjectName("after");
  mode_->setObjectName("mode");
  correction_->setObjectName("correction");
  said_->setObjectName("said");
  mode_->addItems({"off", "rigid", "full", "endpoint"});
  progress_->setRange(0, 1000);
  progress_->setFormat("no training yet");
  retrain_->setToolTip(
      "Learn from all recordings of the trainer's directory; the model goes live if it is better");
  roll_back_->setToolTip("Make the model before the present one live again");
  mode_->setToolTip("off: the planner's poses pass unchanged");

  auto* const grid = new QGridLayout(this);
  int row = 0;
  const auto add = [&](const char* title, QWidget* left, QWidget* right) {
    grid->addWidget(new QLabel(title), row, 0);
    if (right) {
      grid->addWidget(left, row, 1);
      grid->addWidget(right, row, 2);
    } else {
      grid->addWidget(left, row, 1, 1, 2);
    }
    ++row;
  };
  add("Arm", arm_, nullptr);
  add("Recording", record_, nullptr);
  add("", recorder_, nullptr);
  add("Model", retrain_, roll_back_);
  add("", progress_, nullptr);
  add("", model_, nullptr);
  add("Error before", before_, nullptr);
  add("Error after", after_, nullptr);
  add("Correction", mode_, nullptr);
  add("", correction_, nullptr);
  add("", said_, nullptr);
  grid->setRowStretch(row, 1);

  connect(arm_, &QLineEdit::editingFinished, this, [this] {
    connectArm();
    Q_EMIT armChanged();
  });
  connect(record_, &QPushButton::clicked, this, [this] { toggleRecording(); });
  connect(retrain_, &QPushButton::clicked, this, [this] { retrain(); });
  connect(roll_back_, &QPushButton::clicked, this, [this] { rollBack(); });
  connect(mode_, QOverload<int>::of(&QComboBox::activated), this, [this](int i) { setMode(i); });
  auto* const timer = new QTimer(this);
  connect(timer, &QTimer::timeout, this, [this] { watch(); });
  timer->start(kWatchPeriod);
  connectArm();
}

void SessionControls::setArm(const QString& arm) {
  arm_->setText(arm);
  connectArm();
}

int SessionControls::unanswered() { return calls; }

QString SessionControls::arm() const { return arm_->text(); }

void SessionControls::connectArm() {
  subscribers_.clear();
  recorder_seen_ = status_seen_ = ros::SteadyTime();
  recording_ = false;
  before_->setText("-");
  after_->setText("-");
  model_->setText("no model");
  progress_->setValue(0);
  progress_->setFormat("no training yet");
  watch();
  std::string reason;
  const std::string ns = "/" + arm_->text().toStdString();
  if (!ros::names::validate(ns, reason)) {
    say(QString::fromStdString("the arm's namespace is no name: " + reason), false);
    return;
  }
  ros::NodeHandle nh(ns);
  subscribers_ = {nh.subscribe("recorder/status", 10, &SessionControls::onRecorder, this),
                  nh.subscribe("trainer/progress", 10, &SessionControls::onProgress, this),
                  nh.subscribe("trainer/report", 2, &SessionControls::onReport, this),
                  nh.subscribe(topics::kModel, 1, &SessionControls::onModel, this),
                  nh.subscribe(topics::kStatus, 100, &SessionControls::onStatus, this)};
  say("", true);
}

void SessionControls::say(const QString& words, bool good) {
  said_->setText(good ? words : "Failed: " + words);  // never by colour alone
  said_->setStyleSheet(good ? "" : "font-weight: bold");
}

void SessionControls::ask(QPushButton* button, const QString& what, std::function<Answer()> call) {
  if (button) button->setEnabled(false);
  say(what + " ...", true);
  ++calls;
  const QPointer<SessionControls> self(this);
  std::thread([self, button, call = std::move(call)] {
    const Answer answer = call();
    // In the thread of the window, where it can be seen whether the widget is still there.
    QMetaObject::invokeMethod(
        QCoreApplication::instance(),
        [self, button, answer] {
          --calls;
          if (!self) return;
          if (button) button->setEnabled(true);
          self->say(QString::fromStdString(answer.words), answer.done);
        },
        Qt::QueuedConnection);
  }).detach();
}

void SessionControls::toggleRecording() {
  const std::string base = "/" + arm_->text().toStdString() + "/recorder/";
  if (recording_) {
    ask(record_, "stopping the recording", [name = base + "stop"] {
      StopRecording service;
      if (!call(name, service)) return Answer{false, noAnswer(name)};
      return Answer{service.response.success != 0, service.response.message};
    });
  } else {
    ask(record_, "starting a recording", [name = base + "start"] {
      StartRecording service;
      if (!call(name, service)) return Answer{false, noAnswer(name)};
      return Answer{service.response.success != 0, service.response.message};
    });
  }
}

void SessionControls::retrain() {
  ask(retrain_, "training", [name = "/" + arm_->text().toStdString() + "/trainer/retrain"] {
    Retrain service;
    if (!call(name, service)) return Answer{false, noAnswer(name)};
    return Answer{service.response.success != 0, service.response.message};
  });
}

void SessionControls::rollBack() {
  ask(roll_back_, "rolling back", [name = "/" + arm_->text().toStdString() + "/trainer/rollback"] {
    std_srvs::Trigger service;
    if (!call(name, service)) return Answer{false, noAnswer(name)};
    return Answer{service.response.success != 0, service.response.message};
  });
}

void SessionControls::setMode(int index) {
  const std::string mode = mode_->itemText(index).toStdString();
  ask(nullptr, "switching to " + mode_->itemText(index),
      [mode, name = "/" + arm_->text().toStdString() + "/corrector/set_mode"] {
        SetMode service;
        service.request.mode = mode;
        if (!call(name, service)) return Answer{false, noAnswer(name)};
        return Answer{service.response.success != 0, service.response.message};
      });
}

void SessionControls::onRecorder(const RecorderStatusConstPtr& message) {
  recorder_seen_ = ros::SteadyTime::now();
  recording_ = message->state == RecorderStatus::RECORDING;
  record_->setText(recording_ ? "Stop recording" : "Start recording");
  std::string words = message->message;
  if (recording_)
    words = format("recording: %u motions, %lu pairs, %.1f MB", message->trajectories,
                   static_cast<unsigned long>(message->pairs),
                   1e-6 * static_cast<double>(message->bytes));
  if (message->dropped > 0)
    words += format("; %lu messages lost", static_cast<unsigned long>(message->dropped));
  recorder_->setText(QString::fromStdString(words));
}

void SessionControls::onProgress(const WorkProgressConstPtr& message) {
  progress_->setValue(static_cast<int>(std::lround(1000.0 * message->fraction)));
  const bool running = message->state == WorkProgress::RUNNING;
  std::string words = running ? message->phase : message->message;
  if (running && message->time_left >= 0.0) words += format(", %.0f s left", message->time_left);
  if (message->state == WorkProgress::SUCCEEDED) words = "trained";
  if (message->state == WorkProgress::FAILED) words = "failed";
  if (message->state == WorkProgress::IDLE) words = "no training yet";
  progress_->setFormat(QString::fromStdString(words) + " (%p%)");
}

void SessionControls::onReport(const TrainingReportConstPtr& message) {
  if (!message->success) return;
  before_->setText(errorWords(message->none_position, message->none_angle));
  after_->setText(errorWords(message->full_position, message->full_angle) +
                  (message->live ? "" : "   (not live: not better)"));
}

void SessionControls::onModel(const CorrectionModelConstPtr& message) {
  model_->setText(QString::fromStdString(
      format("%s\n%u pairs of %u motions, delay %.0f ms", message->id.c_str(),
             message->training_pairs, message->training_trajectories, 1e3 * message->delay)));
}

void SessionControls::onStatus(const CorrectionStatusConstPtr& message) {
  status_seen_ = ros::SteadyTime::now();
  const int index = mode_->findText(QString::fromStdString(message->mode));
  if (index >= 0 && !mode_->view()->isVisible()) mode_->setCurrentIndex(index);
  std::string words = correctorCodeName(static_cast<CorrectorCode>(message->code));
  for (char& c : words)
    if (c == '_') c = ' ';
  correction_->setText(QString::fromStdString(words));
}

void SessionControls::watch() {
  const ros::SteadyTime now = ros::SteadyTime::now();
  const auto silent = [&](const ros::SteadyTime& seen) {
    return seen.isZero() || (now - seen).toSec() > kSilence;
  };
  if (silent(recorder_seen_)) recorder_->setText("the recorder is silent");
  if (silent(status_seen_)) correction_->setText("no poses");
}

}  // namespace raven_correction
