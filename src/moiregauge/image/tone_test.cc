// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/image/tone.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

using Kind = ToneCurve::Kind;

// Values from the tables and formulas of the standards.
TEST(Tone, LightIsThatOfTheStandards) {
  EXPECT_NEAR(light_of({.kind = Kind::kSrgb}, 0.5), 0.21404, 1e-5);
  EXPECT_NEAR(light_of({.kind = Kind::kBt709}, 0.5), 0.25959, 1e-5);
  EXPECT_NEAR(light_of({.kind = Kind::kHlg}, 0.5), 1.0 / 12.0, 1e-9);
  EXPECT_NEAR(light_of({.kind = Kind::kHlg}, 1.0), 1.0, 1e-4);
  EXPECT_NEAR(light_of({.kind = Kind::kPq}, 0.508078), 0.01, 1e-5);  // 100 of 10 000 cd/m^2
  EXPECT_NEAR(light_of({.kind = Kind::kGamma, .gamma = 2.2}, 0.5), 0.21764, 1e-5);
  EXPECT_EQ(light_of({}, 0.3), 0.3);
}

TEST(Tone, VideoHasItsBlackAt16AndItsWhiteAt235) {
  const ToneCurve video{.kind = Kind::kBt709, .is_full_range = false};
  EXPECT_EQ(light_of(video, 16.0 / 255.0), 0.0);
  EXPECT_NEAR(light_of(video, 235.0 / 255.0), 1.0, 1e-12);
  EXPECT_EQ(light_of(video, 5.0 / 255.0), 0.0);
}

TEST(Tone, MoreGreyIsNeverLessLight) {
  for (const Kind kind : {Kind::kSrgb, Kind::kBt709, Kind::kHlg, Kind::kPq, Kind::kGamma}) {
    for (const bool full : {true, false}) {
      const auto table = light_table({.kind = kind, .gamma = 2.4, .is_full_range = full}, 10);
      ASSERT_EQ(table.size(), 1024U);
      EXPECT_EQ(table.front(), 0);
      EXPECT_EQ(table.back(), 65535);
      for (std::size_t k = 1; k < table.size(); ++k) EXPECT_GE(table[k], table[k - 1]);
    }
  }
}

TEST(Tone, NamesAndCurvesConvertBothWays) {
  for (const auto* name : {"linear", "srgb", "bt709", "hlg", "pq", "gamma:2.2"}) {
    const auto curve = tone_curve_named(name);
    ASSERT_TRUE(curve) << name;
    EXPECT_EQ(name_of(*curve), name);
  }
  for (const auto* wrong : {"", "gamma", "gamma:", "gamma:0", "gamma:nan", "gamma:2.2x", "gamma:99", "sRGB"})
    EXPECT_FALSE(tone_curve_named(wrong)) << wrong;
}

}  // namespace
}  // namespace moiregauge::internal
