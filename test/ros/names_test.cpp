// SPDX-License-Identifier: BSD-3-Clause
// Is what a user means by a name what is looked for?
#include "raven_correction/ros/names.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace raven_correction {
namespace {

TEST(Names, LoseOneLeadingSlash) {
  EXPECT_EQ(withoutSlash("/0_link"), "0_link");
  EXPECT_EQ(withoutSlash("raven/left/servo_cp"), "raven/left/servo_cp");
  EXPECT_EQ(withoutSlash(""), "");
}

TEST(Names, BeginAtHomeOnlyWhereTheySaySo) {
  const char* const home = std::getenv("HOME");
  const std::string before = home == nullptr ? "" : home;
  ::setenv("HOME", "/somewhere/raven", 1);
  EXPECT_EQ(expandHome("~"), "/somewhere/raven");
  EXPECT_EQ(expandHome("~/a b.bag"), "/somewhere/raven/a b.bag");
  EXPECT_EQ(expandHome("$HOME/x"), "/somewhere/raven/x");
  for (const char* const as_it_is : {"", "x", "/x/~", "~other/x", "$HOMER/x"})
    EXPECT_EQ(expandHome(as_it_is), as_it_is);
  ::unsetenv("HOME");
  EXPECT_EQ(expandHome("~/x"), "~/x");
  if (home != nullptr) ::setenv("HOME", before.c_str(), 1);
}

}  // namespace
}  // namespace raven_correction
