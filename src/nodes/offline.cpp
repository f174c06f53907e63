// SPDX-License-Identifier: BSD-3-Clause
// The offline command line; every command is in ros/offline_*.cpp.
#include "raven_correction/ros/offline.h"

#include "raven_correction/memory.h"

int main(int argc, char** argv) {
  raven_correction::keepFreedMemory();
  return raven_correction::runOffline(argc, argv);
}
