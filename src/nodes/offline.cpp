// SPDX-License-Identifier: BSD-3-Clause
// The offline command line; every command is in ros/offline_*.cpp.
#include "raven_correction/ros/offline.h"

int main(int argc, char** argv) { return raven_correction::runOffline(argc, argv); }
