// SPDX-License-Identifier: BSD-3-Clause
#include "report_json.h"

namespace raven_correction {

Json componentsJson(const Eigen::Matrix<double, 6, 1>& values) {
  Json json;
  for (int v = 0; v < 6; ++v)
    json[std::string(kVariables[v]) + "_" + unitName(v)] = unitOf(v) * values(v);
  return json;
}

Json cleaningJson(const FateCounts& fates, std::size_t identity_commands) {
  Json rejected = Json::object();
  for (std::size_t i = 1; i < fates.count.size(); ++i)
    if (fates.count[i] > 0) rejected[fateName(static_cast<Fate>(i))] = fates.count[i];
  return {{"total", fates.total()},
          {"kept", fates[Fate::kKept]},
          {"rejected", rejected},
          {"identity_commands", identity_commands}};
}

}  // namespace raven_correction
