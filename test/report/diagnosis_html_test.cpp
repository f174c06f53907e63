// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/diagnosis_html.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "raven_correction/error.h"
#include "raven_correction/report/diagnosis_report.h"
#include "raven_correction/simulation/session.h"
#include "report/page.h"

namespace raven_correction {
namespace {

struct Diagnosed {
  Dataset dataset;
  Verdict verdict;
  std::string page;
  nlohmann::json json;
};

std::string pageOf(const Dataset& dataset, const Verdict& verdict) {
  RunRecord run;
  run.command = "./run offline diagnose session --report page.html";
  return withPlainSpaces(diagnosisHtml(verdict, streamHealth(dataset), "extended.yaml", run));
}

/// A robot with a homing error and a delay, diagnosed as the command line does.
const Diagnosed& diagnosed() {
  static const Diagnosed result = [] {
    const SimulationConfig nominal = loadSimulationConfig("config/simulation/nominal.yaml");
    Eigen::Vector2d truth(0.03, 0.08);
    const SimulationConfig wrong =
        withValues(nominal, {{"joint_offset", 1}, {"command_delay", 0}}, truth);
    Diagnosed all;
    all.dataset = simulateSession(wrong, 10, 5);
    all.dataset.name = "a <session> & more";
    DiagnosisOptions options;
    options.recording.use_encoders = false;
    options.recording.max_samples = 500;
    options.selection.max_causes = 3;
    options.selection.finalists = 4;
    all.verdict = diagnose(all.dataset, nominal, {}, options);
    all.page = pageOf(all.dataset, all.verdict);
    all.json = nlohmann::json::parse(diagnosisJson(all.verdict));
    return all;
  }();
  return result;
}

TEST(DiagnosisHtml, IsOneWellFormedFileWithoutAnythingOutside) {
  EXPECT_EQ(problemsOf(diagnosed().page), "");
  EXPECT_LT(diagnosed().page.size(), 2000000u);
  EXPECT_TRUE(contains(diagnosed().page, "Diagnosis of a &lt;session&gt; &amp; more"));
  EXPECT_GT(picturesOf(diagnosed().page).size(), 30u);
}

TEST(DiagnosisHtml, BeginsWithTheVerdictAndWhatToDo) {
  const std::string& page = diagnosed().page;
  const std::size_t verdict = page.find("class=\"verdict");
  ASSERT_NE(verdict, std::string::npos);
  EXPECT_LT(verdict, page.find("<figure>"));
  EXPECT_LT(page.find("What to do next"), page.find("<figure>"));
  EXPECT_TRUE(contains(page, "extended.yaml"));
  ASSERT_FALSE(diagnosed().verdict.causes.empty());
  for (const std::string& label : diagnosed().verdict.labels) EXPECT_TRUE(contains(page, label));
  // What is held out and what is not stands where the gain does.
  EXPECT_LT(page.find("chosen with all motions in view"), page.find("<figure>"));
}

TEST(DiagnosisHtml, SaysTheNumbersOfTheJson) {
  const nlohmann::json& json = diagnosed().json;
  const std::string& page = diagnosed().page;
  const std::pair<const char*, const char*> rows[] = {
      {"before", "simulation as given"},
      {"after_alignment", "registration and tool frame alone"},
      {"after", "all causes, motions held out"},
      {"after_learning", "and what a process learns from that"}};
  for (const auto& [side, name] : rows) {
    if (!json.contains(side)) continue;
    std::string expected;
    for (const char* const key : {"position_rms_mm", "position_median_mm", "position_p95_mm",
                                  "orientation_rms_deg", "orientation_median_deg"})
      expected += format("<td class=\"number\">%.2f</td>", json[side][key].get<double>());
    EXPECT_TRUE(contains(page, "<td>" + std::string(name) + "</td>" + expected)) << side;
  }
  EXPECT_TRUE(contains(page, format("%.1f %%", json["gain_percent"].get<double>())));
  EXPECT_TRUE(contains(page, format("takes %.1f %% (%.1f to %.1f %%) off the RMS of position",
                                    json["learnable_percent"].get<double>(),
                                    json["learnable_interval_percent"][0].get<double>(),
                                    json["learnable_interval_percent"][1].get<double>())));
  for (const nlohmann::json& cause : json["causes"]) {
    EXPECT_TRUE(
        contains(page, format("%.1f %% (%.1f to %.1f %%)", cause["explained_percent"].get<double>(),
                              cause["interval_percent"][0].get<double>(),
                              cause["interval_percent"][1].get<double>())));
    for (const auto& [symbol, parameter] : cause["parameters"].items())
      EXPECT_TRUE(
          contains(page, format("%s = %.4g", symbol.c_str(), parameter["value"].get<double>())))
          << cause["label"];
  }
  EXPECT_TRUE(contains(page, std::to_string(json["data"]["observations_thinned"].get<int>())));
  EXPECT_TRUE(json["depends_on_before"].contains("delay"));
}

/// All keys of a JSON value, but for names of parameters, of groups and of data counts.
void collectKeys(const nlohmann::json& json, const std::string& parent,
                 std::set<std::string>& keys) {
  if (json.is_array())
    for (const auto& element : json) collectKeys(element, parent, keys);
  if (!json.is_object() || parent == "data") return;
  const bool named = parent == "parameters" || parent.find("depends_on_") == 0;
  for (const auto& [key, value] : json.items()) {
    if (!named) keys.insert(key);
    collectKeys(value, named ? "" : key, keys);
  }
}

// The header is what users of the JSON read.
TEST(DiagnosisJson, HasTheKeysOfItsHeader) {
  std::ifstream file("include/raven_correction/report/diagnosis_report.h");
  std::string header(std::istreambuf_iterator<char>(file), {});
  header = header.substr(header.find("/// {\"causes\""));
  header.resize(header.find("/// Joint data"));
  std::set<std::string> promised, written;
  const std::regex quoted("\"([a-z_0-9]+)\"");
  for (std::sregex_iterator at(header.begin(), header.end(), quoted), end; at != end; ++at)
    promised.insert((*at)[1]);
  Verdict verdict = diagnosed().verdict;  // with everything that need not be there
  verdict.aligned = true;
  verdict.after_alignment = verdict.before;
  Cause& cause = verdict.causes.front();
  Rival rival;
  rival.hypothesis = cause.hypothesis;
  rival.values = cause.values;
  rival.deviations = cause.deviations;
  cause.equals = {rival};
  cause.has_runner_up = true;
  cause.runner_up = cause.hypothesis;
  collectKeys(nlohmann::json::parse(diagnosisJson(verdict)), "", written);
  EXPECT_EQ(written, promised);
}

// "elbow, before" stands beside "elbow, after": what can be compared has the same limits.
TEST(DiagnosisHtml, BeforeAndAfterHaveTheSameLimits) {
  const std::vector<Picture> pictures = picturesOf(diagnosed().page);
  int pairs = 0;
  for (std::size_t i = 0; i + 1 < pictures.size(); ++i) {
    const std::string& title = pictures[i].title;
    const std::size_t at = title.find(", before");
    if (at == std::string::npos) continue;
    EXPECT_EQ(pictures[i + 1].title, title.substr(0, at) + ", after");
    EXPECT_EQ(labelsAtEnd(pictures[i].svg), labelsAtEnd(pictures[i + 1].svg)) << title;
    EXPECT_FALSE(labelsAtEnd(pictures[i].svg).empty()) << title;
    ++pairs;
  }
  EXPECT_GT(pairs, 20);
}

TEST(DiagnosisHtml, EveryFigureSaysHowToReadItAndWhatIsGood) {
  const std::string& page = diagnosed().page;
  EXPECT_EQ(count(page, "<figcaption>"), count(page, "<figure>"));
  EXPECT_EQ(count(page, "<em>Good:</em>"), count(page, "<figure>"));
}

TEST(DiagnosisHtml, HoldsNumbersThatAreNone) {
  Verdict verdict = diagnosed().verdict;
  verdict.figures.before.tool.col(3).setConstant(std::nan(""));
  verdict.figures.after.joints.row(0).setConstant(std::nan(""));
  verdict.shown.groups[0].share = std::nan("");
  verdict.causes[0].share = std::nan("");
  EXPECT_EQ(problemsOf(pageOf(diagnosed().dataset, verdict)), "");
}

// An interval that crosses zero is drawn to its end: the axis goes below zero, too.
TEST(DiagnosisHtml, ShowsIntervalsThatCrossZero) {
  const auto ticks = [](const std::string& page) {
    for (const Picture& picture : picturesOf(page))
      if (contains(picture.svg, "share of the held-out loss")) return picture.svg;
    return std::string();
  };
  Verdict verdict = diagnosed().verdict;
  const std::string minus = ">\xE2\x88\x92";  // at the beginning of a tick's label
  for (Cause& cause : verdict.causes) cause.lower = std::max(cause.lower, 0.0);
  const std::string above = ticks(pageOf(diagnosed().dataset, verdict));
  ASSERT_FALSE(above.empty());
  EXPECT_FALSE(contains(above, minus));
  verdict.causes[0].lower = -0.6;
  EXPECT_TRUE(contains(ticks(pageOf(diagnosed().dataset, verdict)), minus));
}

TEST(DiagnosisHtml, HasNoNoiseFloorWhereNoFramesTellIt) {
  ASSERT_TRUE(contains(diagnosed().page, "noise floor (RMS)"));
  Verdict verdict = diagnosed().verdict;
  verdict.noise_floor = verdict.angle_floor = 0.0;
  const std::string page = pageOf(diagnosed().dataset, verdict);
  EXPECT_FALSE(contains(page, "noise floor (RMS)"));
  EXPECT_FALSE(contains(page, "oise floor 0.00"));
}

TEST(DiagnosisHtml, ClaimsNothingWhereThereIsNothing) {
  Verdict verdict = diagnosed().verdict;
  verdict.causes.clear();
  verdict.labels.clear();
  verdict.unexplained = false;
  const std::string page = pageOf(diagnosed().dataset, verdict);
  EXPECT_EQ(problemsOf(page), "");
  EXPECT_TRUE(contains(page, "nothing is claimed"));
}

TEST(DiagnosisHtml, WorksOnJointStreams) {
  Dataset dataset;
  dataset.name = "joints";
  for (int m = 0; m < 10; ++m) {
    Trajectory trajectory;
    trajectory.id = std::to_string(m);
    trajectory.joint_commands.names = trajectory.joint_observations.names = {"yaw", "slide"};
    for (int i = 0; i < 60; ++i) {
      const double t = 4.0 * m + 0.05 * i;
      Eigen::Vector2d q(0.4 * std::sin(1.3 * t), 0.05 * std::cos(0.9 * t));
      trajectory.joint_commands.samples.push_back({t, q});
      q(0) = 1.02 * q(0) + 0.01 + 1e-4 * std::sin(91.0 * i + m);
      q(1) += 1e-5 * std::sin(77.0 * i + m);
      trajectory.joint_observations.samples.push_back({t + 1e-4, q});
    }
    dataset.trajectories.push_back(trajectory);
  }
  DiagnosisOptions options;
  options.selection.max_causes = 2;
  options.selection.finalists = 3;
  const Verdict verdict = diagnose(dataset, loadSimulationConfig("config/simulation/nominal.yaml"),
                                   {false, true}, options);
  const std::string page = pageOf(dataset, verdict);
  EXPECT_EQ(problemsOf(page), "");
  EXPECT_TRUE(contains(page, "[rad]"));
  EXPECT_TRUE(contains(page, "slide"));
  EXPECT_FALSE(contains(page, "Orientation"));
}

}  // namespace
}  // namespace raven_correction
