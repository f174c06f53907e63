// SPDX-License-Identifier: BSD-3-Clause
// JSON of reports as tables: names are paths, rows are lines, nothing is lost.
#include "raven_correction/report/number_table.h"

#include <gtest/gtest.h>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

TEST(NumberTable, OneLinePerNumber) {
  EXPECT_EQ(csvOfJson(R"({"gain": 0.25, "after": {"rms_mm": 1.5}, "causes": [{"label": "a, \"b\""}],
                          "none": null, "present": true})"),
            "quantity,value\n"
            "gain,0.25\n"
            "after.rms_mm,1.5\n"
            "causes.0.label,\"a, \"\"b\"\"\"\n"
            "none,\n"
            "present,true\n");
}

TEST(NumberTable, OneLinePerRowWithWhatTheyShare) {
  EXPECT_EQ(csvOfJson(R"({"rows": [{"method": "none", "mean": {"x": 1.25}},
                                   {"method": "rigid", "fold": 3}], "delay_s": 0.1})"),
            "method,mean.x,fold,delay_s\n"
            "none,1.25,,0.1\n"
            "rigid,,3,0.1\n");
  EXPECT_EQ(csvOfJson(R"({"rows": [], "delay_s": 0.1})"), "quantity,value\ndelay_s,0.1\n");
}

TEST(NumberTable, RefusesWhatIsNoObject) {
  EXPECT_THROW(csvOfJson("[1, 2]"), InvalidInput);
  EXPECT_THROW(csvOfJson("{"), InvalidInput);
}

}  // namespace
}  // namespace raven_correction
