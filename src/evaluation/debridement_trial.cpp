// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/evaluation/debridement_trial.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

constexpr int kResamples = 2000;

struct Totals {
  double seconds = 0.0, delivered = 0.0, fragments = 0.0;
  double secondsPerFragment() const {
    return delivered > 0.0 ? seconds / delivered : std::numeric_limits<double>::infinity();
  }
  double success() const { return fragments > 0.0 ? delivered / fragments : 0.0; }
};

Totals totalsOf(const std::vector<ClearedField>& fields, const std::vector<std::size_t>& drawn) {
  Totals totals;
  for (const std::size_t i : drawn) {
    totals.seconds += fields[i].seconds;
    totals.delivered += fields[i].delivered;
    totals.fragments += fields[i].fragments;
  }
  return totals;
}

std::vector<std::size_t> all(std::size_t count) {
  std::vector<std::size_t> indices(count);
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  return indices;
}

/// What a number of two conditions is, and its interval: scenes are drawn for both at once. Draws
/// for which it is no number are left out.
PairedComparison compare(const std::vector<ClearedField>& first,
                         const std::vector<ClearedField>& second, std::uint64_t seed,
                         const std::function<double(const Totals&, const Totals&)>& number) {
  const auto same = [](const ClearedField& a, const ClearedField& b) { return a.seed == b.seed; };
  if (first.empty() || !std::equal(first.begin(), first.end(), second.begin(), second.end(), same))
    throw InvalidInput(format("debridement: %zu and %zu scenes are not the same ones", first.size(),
                              second.size()));
  const auto of = [&](const std::vector<std::size_t>& drawn) {
    return number(totalsOf(first, drawn), totalsOf(second, drawn));
  };
  PairedComparison result;
  result.value = of(all(first.size()));
  std::vector<double> resampled;
  bootstrapOverGroups(first.size(), kResamples, seed, [&](const std::vector<std::size_t>& drawn) {
    const double value = of(drawn);
    if (std::isfinite(value)) resampled.push_back(value);
  });
  if (!resampled.empty()) result.interval = interval95(resampled);
  return result;
}

}  // namespace

DebridementSummary summarise(const std::vector<ClearedField>& fields, std::uint64_t seed) {
  if (fields.empty()) throw InvalidInput("debridement: no scene was worked on");
  DebridementSummary summary;
  double busy = 0.0;
  unsigned picked = 0;
  for (const ClearedField& field : fields) {
    ++summary.scenes;
    summary.fragments += field.fragments;
    summary.delivered += field.delivered;
    summary.missed += field.missed;
    summary.dropped += field.dropped;
    summary.waited += field.waited;
    for (const FragmentRecord& record : field.records) {
      ++summary.first_tries;
      summary.first_try_held += record.picked && record.attempts == 1;
      summary.attempts += record.attempts;
      summary.replans += record.replans;
      summary.given_up += !record.picked;
      if (!record.picked) continue;
      busy += record.end - record.begin;
      ++picked;
    }
  }
  const Totals totals = totalsOf(fields, all(fields.size()));
  summary.seconds = totals.seconds;
  summary.seconds_per_fragment = totals.secondsPerFragment();
  summary.success = totals.success();
  summary.busy_per_fragment = picked > 0 ? busy / picked : 0.0;
  if (summary.first_tries > 0)
    summary.retries =
        static_cast<double>(summary.attempts - summary.first_tries) / summary.first_tries;
  std::vector<double> seconds, success;
  bootstrapOverGroups(fields.size(), kResamples, seed, [&](const std::vector<std::size_t>& drawn) {
    const Totals resampled = totalsOf(fields, drawn);
    seconds.push_back(resampled.secondsPerFragment());
    success.push_back(resampled.success());
  });
  summary.seconds_interval = interval95(seconds);
  summary.success_interval = interval95(success);
  return summary;
}

std::optional<PairedComparison> speedUp(const std::vector<ClearedField>& slow,
                                        const std::vector<ClearedField>& fast, std::uint64_t seed) {
  const PairedComparison result =
      compare(slow, fast, seed, [](const Totals& before, const Totals& after) {
        // None delivered is infinitely slow. A draw in which the slow one delivered none says
        // nothing of how much faster the other is.
        return after.delivered > 0.0 || before.delivered == 0.0
                   ? before.secondsPerFragment() / after.secondsPerFragment()
                   : 0.0;
      });
  if (!std::isfinite(result.value)) return std::nullopt;
  return result;
}

PairedComparison successDifference(const std::vector<ClearedField>& reference,
                                   const std::vector<ClearedField>& other, std::uint64_t seed) {
  return compare(reference, other, seed, [](const Totals& before, const Totals& after) {
    return after.success() - before.success();
  });
}

}  // namespace raven_correction
