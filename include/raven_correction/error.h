// SPDX-License-Identifier: BSD-3-Clause
// The one exception of the core library, and the printf-style text it is built with. Any room may
// use it. Answers about the data (did not converge, poorly conditioned) are results, not errors.
#pragma once

#include <stdexcept>
#include <string>

namespace raven_correction {

/// Bad input from a user: a file, a parameter, a message. The text names what was wrong, where,
/// the limit that was broken and the remedy. The command line turns it into exit code 2.
class InvalidInput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// printf into a std::string; the compiler checks the arguments against the format.
std::string format(const char* pattern, ...) __attribute__((format(printf, 1, 2)));

}  // namespace raven_correction
