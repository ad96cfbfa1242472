// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/utc_text.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

TEST(UtcText, AnOffsetIsSubtracted) {
  EXPECT_EQ(utc_text("2026-05-04T09:12:33.000000Z"), "2026-05-04T09:12:33Z");
  EXPECT_EQ(utc_text("2026-05-04 11:12:33.250+02:00"), "2026-05-04T09:12:33.25Z");
  EXPECT_EQ(utc_text("2026-01-01T00:30:00+0545"), "2025-12-31T18:45:00Z");   // another year
  EXPECT_EQ(utc_text("2024-02-28T23:00:00-03:00"), "2024-02-29T02:00:00Z");  // a leap day
}

TEST(UtcText, ATimeWithoutItsZoneIsNotUtc) {
  EXPECT_EQ(utc_text("2026-05-04T09:12:33"), "");
  EXPECT_EQ(utc_text("2026-05-04 09:12:33 "), "");
}

TEST(UtcText, AnImpossibleDateIsRefused) {
  for (const char* text : {"", "Z", "2026-02-30T09:12:33Z", "2026-05-04T24:12:33Z", "2026-05-04T09:60:33Z",
                           "0000-00-00T00:00:00Z", "2026-05-04T09:12Z", "2026-05-04T09:12:33Zulu", "2026-5-4T9:1:3Z",
                           "2026-05-04T09:12:33+99:00", "2026-05-04T09:12:-3Z"})
    EXPECT_EQ(utc_text(text), "") << text;
}

}  // namespace
}  // namespace moiregauge::internal
