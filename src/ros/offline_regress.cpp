// SPDX-License-Identifier: BSD-3-Clause
// offline regress: the Gaussian process engine alone, on two tables of numbers.
#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "raven_correction/dataset/csv.h"
#include "raven_correction/error.h"
#include "raven_correction/regression/regress.h"
#include "raven_correction/ros/offline.h"

namespace raven_correction {
namespace {

struct Arguments {
  std::string train, test, kernel, backend, mean = "zero";
  NumberFiles numbers;
  int targets = 1;
  bool isotropic = false, shared = false;
  GpConfig config = regressDefaults();
};

RegressProblem problemOf(const Arguments& arguments) {
  const CsvTable train = readCsv(arguments.train, "");
  const CsvTable test = readCsv(arguments.test, "");
  if (train.columns != test.columns)
    throw InvalidInput(
        format("%s and %s have different columns; the last --targets columns of both "
               "are what is predicted from the others",
               arguments.train.c_str(), arguments.test.c_str()));
  RegressProblem problem;
  problem.train = train.values;
  problem.test = test.values;
  problem.targets = arguments.targets;
  problem.config = arguments.config;
  if (!arguments.kernel.empty()) problem.config.kernel = kernelFromName(arguments.kernel);
  if (!arguments.backend.empty()) problem.config.backend = backendFromName(arguments.backend);
  problem.config.mean = meanFromName(arguments.mean);
  problem.config.ard = !arguments.isotropic;
  if (arguments.shared) {
    problem.config.groups.emplace_back();
    for (int k = 0; k < arguments.targets; ++k) problem.config.groups[0].push_back(k);
  }
  return problem;
}

std::string regressText(const RegressResult& result, const GpConfig& config) {
  std::string text =
      format("%td training rows, %td test rows; %s posterior on %d rows, kernel %s\n",
             result.n_train, result.n_test, backendName(config.backend), result.report.rows_used,
             kernelName(config.kernel));
  text += "target       SMSE       RMSE       NLPD   95 % interval covers\n";
  for (std::size_t k = 0; k < result.outputs.size(); ++k) {
    const PredictionScore& score = result.outputs[k];
    text += format("%6zu %10.5f %10.5f %10.4f   %.1f %%\n", k, score.smse, score.rmse, score.nlpd,
                   100.0 * score.coverage95);
  }
  text += format("log marginal likelihood %.3f on %d rows\n", result.log_marginal_likelihood,
                 result.report.rows_learnt_on);
  for (std::size_t g = 0; g < result.report.groups.size(); ++g) {
    const GpFitReport::Group& group = result.report.groups[g];
    text += format("group %zu: %s, %d iterations, jitter %g\n", g, group.message.c_str(),
                   group.iterations, group.jitter);
  }
  text += format(
      "seconds: %.2f hyper-parameters, %.2f posterior, %.2f means; %.2f variances of the first "
      "rows\n",
      result.seconds_hyperparameters, result.seconds_posterior, result.seconds_predict,
      result.seconds_variance);
  return text;
}

std::string regressJson(const RegressResult& result, const GpConfig& config) {
  nlohmann::ordered_json json;
  json["outputs"] = nlohmann::ordered_json::array();
  for (const PredictionScore& score : result.outputs)
    json["outputs"].push_back({{"smse", score.smse},
                               {"rmse", score.rmse},
                               {"nlpd", score.nlpd},
                               {"coverage95", score.coverage95}});
  json["log_marginal_likelihood"] = result.log_marginal_likelihood;
  json["seconds"] = {{"hyperparameters", result.seconds_hyperparameters},
                     {"posterior", result.seconds_posterior},
                     {"predict", result.seconds_predict},
                     {"variance", result.seconds_variance}};
  json["n_train"] = result.n_train;
  json["n_test"] = result.n_test;
  json["backend"] = backendName(config.backend);
  json["kernel"] = kernelName(config.kernel);
  json["n_hyperparameters"] = result.report.rows_learnt_on;
  json["n_posterior"] = result.report.rows_used;
  json["n_variance"] = result.n_variance;
  for (const GpFitReport::Group& group : result.report.groups)
    json["groups"].push_back({{"converged", group.converged},
                              {"message", group.message},
                              {"iterations", group.iterations},
                              {"jitter", group.jitter}});
  return json.dump(1) + "\n";
}

void regressTables(const Arguments& arguments) {
  checkNumberFiles(arguments.numbers);
  const RegressProblem problem = problemOf(arguments);
  const RegressResult result = regress(problem);
  std::fputs(regressText(result, problem.config).c_str(), stdout);
  writeNumbers(arguments.numbers, regressJson(result, problem.config));
}

}  // namespace

void addRegressCommand(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* const command = app.add_subcommand(
      "regress",
      "The Gaussian process engine alone: learns from one CSV table, predicts another, and says "
      "how well and how fast");
  command->add_option("--train", arguments->train, "CSV file: features, then targets")->required();
  command->add_option("--test", arguments->test, "CSV file with the same columns")->required();
  command->add_option("--targets", arguments->targets, "how many of the last columns are targets")
      ->required();
  command->add_option("--kernel", arguments->kernel,
                      std::string("squared_exponential, matern32 or matern52; default: ") +
                          kernelName(arguments->config.kernel));
  command->add_option(
      "--backend", arguments->backend,
      std::string("exact or sparse; default: ") + backendName(arguments->config.backend));
  command->add_option("--mean", arguments->mean, "zero, constant or linear; default: zero");
  command->add_flag("--isotropic", arguments->isotropic,
                    "one length scale for all features; default: one each");
  command->add_flag("--shared", arguments->shared,
                    "one kernel for all targets; default: each has its own");
  GpConfig& config = arguments->config;
  command
      ->add_option("--hyper-points", config.max_hyper_points,
                   "rows that the hyper-parameters are learnt on, at most")
      ->capture_default_str();
  command
      ->add_option("--exact-points", config.max_exact_points,
                   "exact: rows of the posterior, at most")
      ->capture_default_str();
  command->add_option("--inducing-points", config.inducing_points, "sparse: inducing points")
      ->capture_default_str();
  command->add_option("--restarts", config.restarts, "searches for the hyper-parameters")
      ->capture_default_str();
  command->add_option("--seed", config.seed, "of every random choice")->capture_default_str();
  addNumberOptions(*command, arguments->numbers);
  command->callback([arguments] { regressTables(*arguments); });
}

}  // namespace raven_correction
