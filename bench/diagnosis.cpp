// SPDX-License-Identifier: BSD-3-Clause
// How often the diagnosis is right: hidden effects of all kinds, joints and sizes, made by the
// independent plant of test/plant, with motion-capture dirt on. Prints the confusion matrix and,
// with
// --json, every session.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "diagnosis/judge.h"
#include "plant/session.h"
#include "raven_correction/error.h"
#include "raven_correction/report/diagnosis_report.h"

namespace {

using namespace raven_correction;
using Json = nlohmann::ordered_json;

struct Arguments {
  int single = 120, two = 40, three = 0, clean = 60, outside = 40;
  double smallest = 3.0, largest = 30.0;
  bool encoders = false;
  std::uint64_t seed = 1;
  std::string json;
};

std::string allNames(const Verdict& verdict) {
  std::string text;
  for (std::size_t i = 0; i < verdict.labels.size(); ++i) {
    text += (text.empty() ? "" : " + ") + verdict.labels[i];
    if (!verdict.causes[i].equals.empty()) text += "*";
  }
  return text.empty() ? "nothing" : text;
}

class Bench {
 public:
  explicit Bench(const Arguments& arguments) : arguments_(arguments) {
    nominal_ = loadSimulationConfig("config/simulation/nominal.yaml");
    options_.trajectories = 40;
    options_.encoders = arguments.encoders;
  }

  void singles() {
    int named = 0, sized = 0, itself = 0, sized_itself = 0, gained = 0, first = 0;
    const auto& effects = plant::hiddenEffects();
    for (int i = 0; i < arguments_.single; ++i) {
      const plant::HiddenEffect hidden =
          draw(effects[static_cast<std::size_t>(i) % effects.size()], i);
      const plant::PlantSession session = plant::recordHidden(options_, {hidden});
      const Verdict verdict = run(session.dataset);
      const Judgement judgement = judge(verdict, session.truth.front());
      const TrueGain gain =
          compareGains(verdict, session.dataset, nominal_, session.truth, diagnosis_.recording);
      named += judgement.named;
      first += judgement.first;
      itself += judgement.itself;
      sized += judgement.size_right;
      sized_itself += judgement.itself && judgement.size_right;
      const bool enough = gain.verdict >= 0.9 * gain.truth;
      gained += enough;
      auto& row = matrix_[hidden.effect];
      ++row[judgement.named ? "named" : verdict.causes.empty() ? "nothing" : "other"];
      countExtras(verdict, session.truth);
      std::printf("%-9s %-60s -> %s%s%s\n", judgement.named ? "named" : "MISSED",
                  plant::describe(session.truth.front()).c_str(), allNames(verdict).c_str(),
                  judgement.named && !judgement.size_right ? "  SIZE" : "",
                  enough ? "" : format("  GAIN %.2f of %.2f", gain.verdict, gain.truth).c_str());
      std::fflush(stdout);
      sessions_.push_back({{"truth", plant::describe(session.truth.front())},
                           {"effect", hidden.effect},
                           {"size_mm", session.truth.front().size_mm},
                           {"size_deg", session.truth.front().size_deg},
                           {"verdict", verdict.labels},
                           {"named", judgement.named},
                           {"size_right", judgement.size_right},
                           {"gain", gain.verdict},
                           {"gain_of_truth", gain.truth},
                           {"seconds", verdict.seconds}});
    }
    if (arguments_.single == 0) return;
    std::printf(
        "\nsingle effects: named %d of %d (as the first cause itself %d), size right in %d (%d of "
        "the "
        "%d named themselves, %d of the %d named as equals), gain at least 90 %% of the truth's in "
        "%d\n",
        named, arguments_.single, first, sized, sized_itself, itself, sized - sized_itself,
        named - itself, gained);
    std::printf("%-22s %6s %6s %8s\n", "effect", "named", "other", "nothing");
    for (auto& [effect, row] : matrix_)
      std::printf("%-22s %6d %6d %8d\n", effect.c_str(), row["named"], row["other"],
                  row["nothing"]);
    printExtras();
    summary_["single"] = {{"sessions", arguments_.single},
                          {"with_other_causes", with_extras_},
                          {"other_causes", extras_},
                          {"largest_other_share", largest_extra_},
                          {"named", named},
                          {"first", first},
                          {"themselves", itself},
                          {"size_right_themselves", sized_itself},
                          {"size_right", sized},
                          {"gain_right", gained}};
  }

  void several(int count, int sessions, const char* key) {
    int all = 0;
    extras_ = with_extras_ = 0;
    largest_extra_ = 0.0;
    for (int i = 0; i < sessions; ++i) {
      options_.seed = arguments_.seed + 10000 * static_cast<std::uint64_t>(count) + i;
      const auto hidden = plant::drawHiddenSet(options_, options_.seed, count, arguments_.smallest,
                                               arguments_.largest);
      const plant::PlantSession session = plant::recordHidden(options_, hidden);
      const Verdict verdict = run(session.dataset);
      bool right = true;
      std::string text;
      for (const plant::HiddenEffect& truth : session.truth) {
        right &= judge(verdict, truth).named;
        text += (text.empty() ? "" : " + ") + plant::describe(truth);
      }
      all += right;
      countExtras(verdict, session.truth);
      std::printf("%-9s %s -> %s\n", right ? "named" : "MISSED", text.c_str(),
                  allNames(verdict).c_str());
      std::fflush(stdout);
    }
    if (sessions == 0) return;
    std::printf("\n%d effects at once: all named in %d of %d\n", count, all, sessions);
    printExtras();
    summary_[key] = {{"sessions", sessions},
                     {"all_named", all},
                     {"with_other_causes", with_extras_},
                     {"other_causes", extras_},
                     {"largest_other_share", largest_extra_}};
  }

  void clean() {
    int claims = 0, structures = 0;
    for (int i = 0; i < arguments_.clean; ++i) {
      options_.seed = arguments_.seed + 50000 + i;
      const Verdict verdict = run(plant::recordClean(options_).dataset);
      claims += !verdict.causes.empty();
      structures += verdict.unexplained;
      if (!verdict.causes.empty() || verdict.unexplained)
        std::printf("%-9s clean -> %s%s\n", verdict.causes.empty() ? "silent" : "CLAIM",
                    allNames(verdict).c_str(), verdict.unexplained ? ", structure left" : "");
      std::fflush(stdout);
    }
    if (arguments_.clean == 0) return;
    std::printf("\nclean sessions: a claim in %d of %d, structure seen in %d\n", claims,
                arguments_.clean, structures);
    summary_["clean"] = {
        {"sessions", arguments_.clean}, {"claims", claims}, {"structure", structures}};
  }

  void outside() {
    int right = 0, total = 0;
    const auto& kinds = plant::outsideKinds();
    for (int i = 0; i < arguments_.outside; ++i) {
      const plant::OutsideKind kind = kinds[static_cast<std::size_t>(i) % kinds.size()];
      options_.seed = arguments_.seed + 70000 + i;
      const plant::PlantSession session = plant::recordOutside(options_, kind, 15.0, options_.seed);
      const Verdict verdict = run(session.dataset);
      // However many causes: together they claim no more than half of the error.
      const double turned = verdict.before.sizes.orientation_median > 0.0
                                ? 1.0 - verdict.after.sizes.orientation_median /
                                            verdict.before.sizes.orientation_median
                                : 0.0;
      const double claimed = std::max(verdict.gain, turned);
      const bool ok = verdict.unexplained && claimed <= 0.5;
      if (!plant::isNearCatalogue(kind)) {
        right += ok;
        ++total;
      }
      std::printf("%-9s %s%s (%.2f mm, %.2f deg) -> %s (%.0f %%)%s\n", ok ? "right" : "WRONG",
                  session.outside.c_str(), plant::isNearCatalogue(kind) ? " (near)" : "",
                  session.outside_size_mm, session.outside_size_deg, allNames(verdict).c_str(),
                  100.0 * claimed, verdict.unexplained ? ", structure left" : "");
      std::fflush(stdout);
    }
    if (total == 0) return;
    std::printf("\noutside the catalogue: structure reported and nobody blamed in %d of %d\n",
                right, total);
    summary_["outside"] = {{"sessions", total}, {"right", right}};
  }

  void write() const {
    if (arguments_.json.empty()) return;
    Json json = summary_;
    json["sizes"] = {arguments_.smallest, arguments_.largest};
    json["seed"] = arguments_.seed;
    json["encoders"] = arguments_.encoders;
    json["sessions"] = sessions_;
    std::ofstream(arguments_.json) << json.dump(1) << "\n";
  }

 private:
  /// Causes that are none of the hidden ones, nor their equals.
  void countExtras(const Verdict& verdict, const std::vector<plant::HiddenEffect>& truth) {
    int here = 0;
    for (const Cause& cause : verdict.causes) {
      const bool true_one =
          std::any_of(truth.begin(), truth.end(), [&](const plant::HiddenEffect& hidden) {
            return names(cause, hidden, verdict.simulation.robot);
          });
      if (true_one) continue;
      ++here;
      largest_extra_ = std::max(largest_extra_, cause.share);
    }
    extras_ += here;
    with_extras_ += here > 0;
  }
  void printExtras() const {
    std::printf("beside them in %d sessions %d other causes, of at most %.1f %% of the loss\n",
                with_extras_, extras_, 100.0 * largest_extra_);
  }
  plant::HiddenEffect draw(const std::string& effect, int i) {
    options_.seed = arguments_.seed + static_cast<std::uint64_t>(i);
    return plant::drawHidden(options_, effect, options_.seed, arguments_.smallest,
                             arguments_.largest);
  }
  Verdict run(const Dataset& dataset) {
    diagnosis_.recording.use_encoders = arguments_.encoders;
    return diagnose(dataset, nominal_, {}, diagnosis_);
  }

  Arguments arguments_;
  SimulationConfig nominal_;
  plant::PlantOptions options_;
  DiagnosisOptions diagnosis_;
  std::map<std::string, std::map<std::string, int>> matrix_;
  int extras_ = 0, with_extras_ = 0;
  double largest_extra_ = 0.0;
  Json summary_ = Json::object(), sessions_ = Json::array();
};

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("How often the diagnosis names what an independent plant hides");
  app.add_option("--single", arguments.single, "sessions with one hidden effect");
  app.add_option("--two", arguments.two, "sessions with two");
  app.add_option("--three", arguments.three, "sessions with three");
  app.add_option("--clean", arguments.clean, "sessions without any");
  app.add_option("--outside", arguments.outside, "sessions with an effect outside the catalogue");
  app.add_option("--smallest", arguments.smallest, "size, in multiples of the noise");
  app.add_option("--largest", arguments.largest, "size, in multiples of the noise");
  app.add_flag("--encoders", arguments.encoders, "sessions have encoder streams");
  app.add_option("--seed", arguments.seed, "of all sessions");
  app.add_option("--json", arguments.json, "write the numbers as JSON");
  CLI11_PARSE(app, argc, argv);
  try {
    // The plant and the simulation name their files relative to the package.
    if (!arguments.json.empty()) arguments.json = std::filesystem::absolute(arguments.json);
    if (const char* const root = std::getenv("RAVEN_ROOT")) std::filesystem::current_path(root);
    Bench bench(arguments);
    bench.singles();
    bench.several(2, arguments.two, "two");
    bench.several(3, arguments.three, "three");
    bench.clean();
    bench.outside();
    bench.write();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench diagnosis: %s\n", error.what());
    return 2;
  }
  return 0;
}
