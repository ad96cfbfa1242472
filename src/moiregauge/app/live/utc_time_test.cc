// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/live/utc_time.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

TEST(UtcTime, TextAndTimeAreInverse) {
  constexpr std::int64_t kTime = 1'777'885'953'250'000'000;  // date -u -d @1777885953
  EXPECT_EQ(text_of_utc(kTime), "2026-05-04T09:12:33.250Z");
  EXPECT_EQ(utc_of_text("2026-05-04T09:12:33.250Z"), kTime);
  EXPECT_FALSE(utc_of_text("yesterday"));
  EXPECT_FALSE(utc_of_text(""));
}

}  // namespace
}  // namespace moiregauge::internal
