// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/diagnoser_node.h"

#include <cctype>
#include <ctime>
#include <filesystem>
#include <limits>

#include "raven_correction/error.h"
#include "raven_correction/report/diagnosis_report.h"
#include "raven_correction/ros/names.h"
#include "raven_correction/ros/offline.h"
#include "raven_correction/ros/session_bag.h"

namespace raven_correction {
namespace {

namespace fs = std::filesystem;

constexpr double kPercent = 100.0;
constexpr double kMillimetre = 1e3;
constexpr double kReading = 0.02;  // share of the work that is reading [-]

/// "session_20260131T120000Z.yaml": what the file is of, and when it was made.
std::string madeName(const std::string& recording) {
  std::string name;
  for (const char c : recording.empty() ? std::string("recording") : recording)
    name += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' ? c : '_';
  const std::time_t now = ros::WallTime::now().sec;
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof(text), "_%Y%m%dT%H%M%SZ", &utc);
  return name + text + ".yaml";
}

std::string within(const std::string& directory, const std::string& file) {
  const std::string path = expandHome(file);
  return fs::path(path).is_relative() ? (fs::path(directory) / path).string() : path;
}

DiagnosisJob jobOf(const Diagnose::Request& request) {
  DiagnosisJob job;
  if (!request.driven_by.empty()) job.from = request.driven_by;
  if (job.from != "commands" && job.from != "encoders")
    throw InvalidInput(
        format("driven_by \"%s\" is not known; commands or encoders", request.driven_by.c_str()));
  job.ignore_encoders = request.ignore_encoders;
  job.leave_out_validation = request.leave_out_validation;
  job.prismatic = request.prismatic;
  const auto number = [](const char* name, std::uint32_t value, std::uint32_t low,
                         std::uint32_t high, auto& option) {
    if (value == 0) return;
    if (value < low || value > high)
      throw InvalidInput(
          format("%s = %u is outside [%u, %u]; 0 is the default", name, value, low, high));
    option = value;
  };
  number("max_causes", request.max_causes, 1, 1000, job.options.selection.max_causes);
  number("max_samples", request.max_samples, 1, 100000000, job.options.recording.max_samples);
  number("folds", request.folds, 2, 100, job.options.selection.folds);
  if (request.seed != 0) job.options.selection.seed = request.seed;
  return job;
}

}  // namespace

DiagnoserParams loadDiagnoserParams(const ros::NodeHandle& nh) {
  DiagnoserParams params;
  ParamReader read(nh, "diagnoser");
  read.text("data_directory", params.data_directory);
  read.text("simulation_directory", params.simulation_directory);
  read.text("simulation", params.simulation);
  read.refuseUnknownKeys();
  read.throwIfAnyProblem();
  ROS_INFO("%s", read.summary().c_str());
  params.data_directory = expandHome(params.data_directory);
  params.simulation_directory = expandHome(params.simulation_directory);
  params.simulation = params.simulation.empty() ? packageFile("config/simulation/nominal.yaml")
                                                : expandHome(params.simulation);
  return params;
}

DiagnoserNode::DiagnoserNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh)
    : nh_(nh),
      private_nh_(private_nh),
      params_(loadDiagnoserParams(private_nh)),
      work_(private_nh_, "a diagnosis", "~diagnose") {
  loadSimulationConfig(params_.simulation);  // a mistake in it is better found now than later
  verdict_publisher_ = private_nh_.advertise<DiagnosisVerdict>("verdict", 1, true);
  diagnose_service_ = private_nh_.advertiseService("diagnose", &DiagnoserNode::onDiagnose, this);
  ROS_INFO("diagnoser: %s against recordings of %s, diagnose with %s", params_.simulation.c_str(),
           params_.data_directory.c_str(), diagnose_service_.getService().c_str());
}

void DiagnoserNode::diagnoseRequest(const Diagnose::Request& request,
                                    Diagnose::Response& response) {
  work_.report("reading", 0.0);
  DiagnosisJob job = jobOf(request);
  const SimulationConfig simulation = loadSimulationConfig(
      request.simulation.empty() ? params_.simulation : expandHome(request.simulation));
  const std::string json =
      request.json.empty() ? "" : within(params_.simulation_directory, request.json);
  const Dataset dataset = readInputs(inputsNamed(request.inputs, params_.data_directory));
  const bool writes = !request.dry_run && (!isJointData(dataset) || !request.output.empty());
  if (writes)
    job.output = within(params_.simulation_directory,
                        request.output.empty() ? madeName(dataset.name) : request.output);
  if (!request.dry_run) {  // now, not after the diagnosis
    fs::create_directories(params_.simulation_directory);
    checkOutputFile(job.output, false);
    checkOutputFile(json, false);
  }
  const Verdict verdict =
      runDiagnosis(dataset, simulation, job, [&](const std::string& phase, double fraction) {
        work_.report(phase, kReading + (1.0 - kReading) * fraction);
      });
  work_.report("saving", 1.0);
  if (writes) {
    saveSimulationConfig(verdict.simulation, job.output);
    response.files.push_back(fs::absolute(job.output).string());
  }
  if (!request.dry_run && !json.empty()) {
    writeTextFile(json, diagnosisJson(verdict));
    response.files.push_back(fs::absolute(json).string());
  }
  DiagnosisVerdict msg = verdictToMsg(verdict, dataset.frame, simulation.name);
  msg.header.stamp = ros::Time::now();
  if (writes) msg.file = response.files.front();
  verdict_publisher_.publish(msg);

  for (const DiagnosisCause& cause : msg.causes) {
    response.causes.push_back(cause.label);
    response.shares.push_back(cause.share);
  }
  response.unexplained = msg.unexplained;
  response.before_rms_mm = kMillimetre * msg.before.position_rms;
  response.after_rms_mm = kMillimetre * msg.after.position_rms;
  response.gain_percent = kPercent * msg.gain;
  response.gain_lower_percent = kPercent * msg.gain_lower;
  response.gain_upper_percent = kPercent * msg.gain_upper;
  response.message = verdictSentence(verdict);
  if (request.dry_run) response.message += "; dry run: nothing written";
  response.seconds = work_.seconds();
}

bool DiagnoserNode::onDiagnose(Diagnose::Request& request, Diagnose::Response& response) {
  const LongWork::Result result = work_.run([&] {
    diagnoseRequest(request, response);
    return response.message;
  });
  if (!result.success) response = Diagnose::Response();
  response.success = result.success;
  response.message = result.message;
  ROS_INFO("diagnoser: %s", response.message.c_str());
  return true;
}

}  // namespace raven_correction
