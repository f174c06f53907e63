// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/evaluation/debridement_trial.h"

#include <algorithm>
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
  summary.success = totals.fragments > 0.0 ? totals.delivered / totals.fragments : 0.0;
  summary.busy_per_fragment = picked > 0 ? busy / picked : 0.0;
  if (summary.first_tries > 0)
    summary.retries =
        static_cast<double>(summary.attempts - summary.first_tries) / summary.first_tries;
  std::vector<double> seconds, success;
  bootstrapOverGroups(fields.size(), kResamples, seed, [&](const std::vector<std::size_t>& drawn) {
    const Totals resampled = totalsOf(fields, drawn);
    seconds.push_back(resampled.secondsPerFragment());
    success.push_back(resampled.fragments > 0.0 ? resampled.delivered / resampled.fragments : 0.0);
  });
  summary.seconds_interval = interval95(seconds);
  summary.success_interval = interval95(success);
  return summary;
}

SpeedUp speedUp(const std::vector<ClearedField>& slow, const std::vector<ClearedField>& fast,
                std::uint64_t seed) {
  const auto same = [](const ClearedField& a, const ClearedField& b) { return a.seed == b.seed; };
  if (slow.empty() || !std::equal(slow.begin(), slow.end(), fast.begin(), fast.end(), same))
    throw InvalidInput(
        format("debridement: %zu and %zu scenes are not the same ones", slow.size(), fast.size()));
  const auto ratio = [&](const std::vector<std::size_t>& drawn) {
    return totalsOf(slow, drawn).secondsPerFragment() / totalsOf(fast, drawn).secondsPerFragment();
  };
  SpeedUp result;
  result.value = ratio(all(slow.size()));
  if (!(result.value > 0.0 && result.value < std::numeric_limits<double>::infinity()))
    throw InvalidInput("debridement: nothing was delivered, so there is no time per fragment");
  std::vector<double> resampled;
  bootstrapOverGroups(slow.size(), kResamples, seed, [&](const std::vector<std::size_t>& drawn) {
    const double value = ratio(drawn);
    // A draw without a delivered fragment has no ratio.
    if (value > 0.0 && value < std::numeric_limits<double>::infinity()) resampled.push_back(value);
  });
  result.interval = interval95(resampled);
  return result;
}

}  // namespace raven_correction
