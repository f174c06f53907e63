// SPDX-License-Identifier: BSD-3-Clause
// offline compare: resting error at the same targets before and after, from two recordings.
#include <CLI/CLI.hpp>
#include <memory>

#include "raven_correction/error.h"
#include "raven_correction/evaluation/visits.h"
#include "raven_correction/report/visits_report.h"
#include "raven_correction/ros/offline.h"
#include "raven_correction/ros/session_visits.h"

namespace raven_correction {
namespace {

struct Arguments {
  std::string before, after, bag, model;
  NumberFiles numbers;
  double rest = 0.3;
  double max_ratio = 0.0;
};

void compare(const Arguments& arguments) {
  checkNumberFiles(arguments.numbers);
  const VisitComparison comparison = compareVisits(readVisits(arguments.before, arguments.rest),
                                                   readVisits(arguments.after, arguments.rest));
  std::fputs(visitsText(comparison).c_str(), stdout);
  writeNumbers(arguments.numbers, visitsJson(comparison, arguments.bag, arguments.model));
  if (!(arguments.max_ratio > 0.0)) return;
  const ErrorSummary& before = comparison.summary_before;
  const ErrorSummary& after = comparison.summary_after;
  const double position = after.position_norm / before.position_norm;
  const double angle = after.angle_norm / before.angle_norm;
  if (position < arguments.max_ratio && angle < arguments.max_ratio) return;
  std::fprintf(stderr,
               "offline: the error after is %.3f (position) and %.3f (angle) of the error before, "
               "must be below %.3f\n",
               position, angle, arguments.max_ratio);
  throw CLI::RuntimeError(1);
}

}  // namespace

void addCompareCommand(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* const command = app.add_subcommand(
      "compare", "Resting error at the same targets, before and after: two recorded bags");
  command->add_option("BEFORE", arguments->before, "bag of the first visits")->required();
  command->add_option("AFTER", arguments->after, "bag of the second visits")->required();
  command->add_option("--rest", arguments->rest,
                      "duration before the end of a trajectory in which the tool is at rest [s]");
  command->add_option("--max-ratio", arguments->max_ratio,
                      "exit with 1 unless both norms after are below this share of those before");
  addNumberOptions(*command, arguments->numbers);
  command->add_option("--bag", arguments->bag, "name of the training bag, for the JSON");
  command->add_option("--model", arguments->model, "name of the model file, for the JSON");
  command->callback([arguments] { compare(*arguments); });
}

}  // namespace raven_correction
