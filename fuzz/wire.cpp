// SPDX-License-Identifier: BSD-3-Clause
// Fuzz target: messages of others that are read from their bytes, RavenCommand and the robots'
// states.
#include "fuzz/fuzz_target.h"
#include "raven_correction/ros/pose_command.h"
#include "raven_correction/ros/robot_state.h"
#include "support/raven_bytes.h"

namespace raven_correction {
namespace fuzz {
namespace {

const char* const kStateSums[] = {"b1bd4021639d9d9c5fbfff78d6ff3158",
                                  "2489ec3d939b556c05d31ea2958841b2",
                                  "ce9e7f4969049d8bb365de3c98461a01"};

}  // namespace

std::vector<Bytes> goodInputs() {
  std::vector<Bytes> inputs{forReader(0, command({"L", "R"})), forReader(0, command({"L"}, 15))};
  for (std::uint8_t kind = 1; kind <= std::size(kStateSums); ++kind)
    inputs.push_back(forReader(kind, Bytes(400, 1)));
  return inputs;
}

void read(const Bytes& input) {
  if (input.empty()) return;
  const Bytes bytes(input.begin() + 1, input.end());
  const std::size_t kind = input[0] % (1 + std::size(kStateSums));
  if (kind > 0) {
    readRobotState(kStateSums[kind - 1], bytes);
    return;
  }
  RavenCommand message{bytes};
  CommandRequest request;
  if (!readCommand(message, {"L", "R"}, request)) return;
  for (const ArmRequest& arm : request.arms)
    if (arm.kind == ArmRequest::Kind::kPose) writeCommand(message, arm, Pose());
  if (message.bytes.size() != bytes.size()) throw std::logic_error("the message changed its size");
}

}  // namespace fuzz
}  // namespace raven_correction
