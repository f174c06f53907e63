# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# How ./run talks: everything about its own work goes to stderr, so that stdout belongs to the
# program it was asked to run.

say() { printf '%s\n' "run: $*" >&2; }

# refuse TEXT...: bad usage or something the user has to do; exit code 2
refuse() {
  printf '%s\n' "run: $*" >&2
  exit 2
}

# fail TEXT...: the work itself failed; exit code 1
fail() {
  printf '%s\n' "run: $*" >&2
  exit 1
}
