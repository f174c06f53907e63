// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/dataset/topic_check.h"

#include <algorithm>
#include <cctype>

namespace raven_correction {
namespace {

using Severity = StreamFinding::Severity;

/// Words of a name: "/raven/left/mocap/measured_cp" has raven, left, mocap, measured, cp.
std::vector<std::string> wordsOf(const std::string& topic) {
  std::vector<std::string> words(1);
  for (const char c : topic)
    if (c == '/' || c == '_')
      words.emplace_back();
    else
      words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  words.erase(std::remove(words.begin(), words.end(), ""), words.end());
  return words;
}

std::size_t commonWords(const std::string& a, const std::string& b) {
  const std::vector<std::string> of_b = wordsOf(b);
  std::size_t common = 0;
  for (const std::string& word : wordsOf(a))
    common += std::find(of_b.begin(), of_b.end(), word) != of_b.end() ? 1 : 0;
  return common;
}

}  // namespace

std::vector<StreamFinding> checkTopics(const std::vector<TopicType>& expected,
                                       const std::vector<TopicType>& published) {
  std::vector<StreamFinding> findings;
  const auto isExpected = [&](const std::string& topic) {
    return std::any_of(expected.begin(), expected.end(),
                       [&](const TopicType& other) { return other.topic == topic; });
  };
  for (const TopicType& wanted : expected) {
    const auto found = std::find_if(published.begin(), published.end(),
                                    [&](const TopicType& p) { return p.topic == wanted.topic; });
    if (found != published.end()) {
      if (!wanted.type.empty() && found->type != wanted.type && found->type != "*")
        findings.push_back({Severity::kError, wanted.topic, "type",
                            "it is published as " + found->type, wanted.type,
                            "set the message type of this node (pose_type, command_type or "
                            "mocap_pose_type), or the topic"});
      continue;
    }
    struct Candidate {
      const TopicType* topic;
      std::size_t score;
    };
    std::vector<Candidate> candidates;
    for (const TopicType& other : published) {
      if (isExpected(other.topic)) continue;
      const bool same_type = !wanted.type.empty() && other.type == wanted.type;
      const std::size_t common = commonWords(wanted.topic, other.topic);
      if (same_type || common >= 2) candidates.push_back({&other, common + (same_type ? 3 : 0)});
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
    constexpr std::size_t kNamed = 3;
    std::string instead;
    for (std::size_t i = 0; i < std::min(kNamed, candidates.size()); ++i)
      instead += (i == 0 ? "" : ", ") + candidates[i].topic->topic + " [" +
                 candidates[i].topic->type + "]";
    findings.push_back(
        {Severity::kWarning, wanted.topic, "missing", "nobody publishes it",
         wanted.type.empty() ? "a publisher" : "a publisher of " + wanted.type,
         instead.empty()
             ? "nothing like it is there: start what publishes it, or remap the topic"
             : "there is " + instead + ": remap the topic, or start what publishes it"});
  }
  return findings;
}

}  // namespace raven_correction
