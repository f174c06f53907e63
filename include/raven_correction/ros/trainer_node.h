// SPDX-License-Identifier: BSD-3-Clause
// The trainer: services that learn, load, save and roll back models, progress meanwhile, and the
// live model on a latched topic. What training does is evaluation/validated_training.h.
#pragma once

#include <raven_correction/LoadModel.h>
#include <raven_correction/Retrain.h>
#include <raven_correction/SaveModel.h>
#include <raven_correction/TrainingReport.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <mutex>
#include <string>
#include <vector>

#include "raven_correction/evaluation/validated_training.h"
#include "raven_correction/ros/long_work.h"
#include "raven_correction/ros/params.h"
#include "raven_correction/ros/session_bag.h"

namespace raven_correction {

struct TrainerParams {
  std::string data_directory = "~/raven_sessions";  ///< bags to learn from where none are named
  std::string model_directory = "~/raven_models";   ///< where models are written
  std::string configuration;  ///< trainer configuration; empty: config/trainer.yaml of the package
  std::string model;          ///< model file to start with; empty: none
  std::string arm;            ///< whose recordings are learned from; empty: as they say
  std::string tool;           ///< on that arm; empty: not known
  std::string pose_type;      ///< message type of the commands; empty: not known
  std::string robot;       ///< chain of the arm, for the checks of recordings; empty: not checked
  std::string play_robot;  ///< chain whose joints' play models know; empty: as configured
  std::vector<std::string> other_robots;  ///< chains of arms it could be mixed up with
  double valid_hours = 0.0;  ///< a model is not taken into use later than this; 0: no limit [h]
};
/// `~` at the start of a directory becomes $HOME.
/// @throws InvalidInput  lists every problem
TrainerParams loadTrainerParams(const ros::NodeHandle& nh);

/// Services are called from several threads (AsyncSpinner); one training runs at a time.
class TrainerNode {
 public:
  /// @throws InvalidInput  see loadTrainerParams(), loadTrainingConfig() and readModelFile()
  TrainerNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh);

 private:
  bool onRetrain(Retrain::Request& request, Retrain::Response& response);
  bool onRollback(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool onLoad(LoadModel::Request& request, LoadModel::Response& response);
  bool onSave(SaveModel::Request& request, SaveModel::Response& response);

  void retrain(const Retrain::Request& request, Retrain::Response& response);
  /// @throws InvalidInput  see loadTrainingConfig() and knowRobot()
  TrainingConfig configurationFrom(const std::string& file) const;
  void goLive(const Correction& model);
  void publishLive(const Correction& model);
  std::string goLiveInsteadOf(const std::string& before, const Correction& model, bool force);
  void identify(Correction& model) const;
  void publishReport(const ValidatedTraining& result, const Retrain::Response& response);
  CheckedInputs readChecked(const std::vector<std::string>& names, bool ignore_checks,
                            Retrain::Response& response);

  ros::NodeHandle nh_, private_nh_;
  TrainerParams params_;
  LongWork work_;

  // Guarded by mutex_.
  std::mutex mutex_;
  std::vector<Correction> live_;  // every model that went live, newest last

  ros::Publisher model_publisher_, samples_publisher_, report_publisher_;
  // Declared last: their callbacks use everything above.
  ros::ServiceServer retrain_service_, rollback_service_, load_service_, save_service_;
};

}  // namespace raven_correction
