// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/duration_text.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

TEST(DurationText, ReadsMillisecondsSecondsAndMicroseconds) {
  EXPECT_EQ(duration_s("18ms").value(), 0.018);
  EXPECT_EQ(duration_s(" 0.018 s ").value(), 0.018);
  EXPECT_EQ(duration_s("18000us").value(), 0.018);
  EXPECT_EQ(duration_s("0ms").value(), 0.0);
}

TEST(DurationText, RefusesTextsWithoutUnitAndInvalidDurations) {
  EXPECT_NE(duration_s("18").error().find("write 18ms"), std::string::npos);
  for (const char* text : {"", "ms", "-1ms", "nan ms", "inf s", "18 min", "1,8ms", "18ms18"})
    EXPECT_FALSE(duration_s(text)) << text;
}

TEST(DurationText, ReadsLongDurations) {
  EXPECT_EQ(long_duration_s("90s").value(), 90.0);
  EXPECT_EQ(long_duration_s("10 min").value(), 600.0);
  EXPECT_EQ(long_duration_s("1.5h").value(), 5400.0);
  EXPECT_EQ(long_duration_s("30d").value(), 2'592'000.0);
  for (const char* text : {"10", "10ms", "1 week", "-1h"}) EXPECT_FALSE(long_duration_s(text)) << text;
}

}  // namespace
}  // namespace moiregauge::internal
