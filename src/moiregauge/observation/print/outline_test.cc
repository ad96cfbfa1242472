// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/outline.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/observation/print/picture_for_tests.h"

namespace moiregauge::internal {
namespace {

using test::crossed_lines, test::kPitchPx, test::print, test::seen, test::sheet, test::tinted_lines, test::upright;

std::optional<Outline> outline_of(const Image<std::uint8_t>& picture, double half_pitches) {
  return learn_outline(picture.view(), upright(), print(), {{0.0, 0.0}, half_pitches, half_pitches}, {});
}

// One pitch away, a window loses a strip of the grating. If another pattern of the same pitch continues there, it loses
// only the difference. Blur and dirt can then hide which pitch the phase belongs to.
TEST(Outline, IsNotLearnedIfASimilarPatternContinuesTheGrating) {
  constexpr double kHalf = 1.5;  // pitches; the picture shows 1.6 more on each side
  const auto is_learned = [](double share) {
    const auto grey = [=](double x, double y) {
      const bool is_grating = std::max(std::abs(x), std::abs(y)) < kHalf * kPitchPx;
      return tinted_lines(x, y, is_grating ? 1.0 : share);
    };
    return outline_of(sheet(grey, 1), kHalf).has_value();
  };
  EXPECT_TRUE(is_learned(0.0));
  EXPECT_FALSE(is_learned(0.7));
  EXPECT_FALSE(is_learned(1.0));
}

// Something flat covers the grating from the left.
Image<std::uint8_t> visible_part(double share) {
  const double edge = (0.5 - share) * test::kPitches * kPitchPx;
  return seen([=](double x, double y) { return x < edge ? 110.0 : crossed_lines(x, y); }, 1);
}

// Less than half of a grating may also be a corner of something else.
TEST(Outline, AGratingOfWhichAThirdIsVisibleIsNotFound) {
  const auto outline = outline_of(seen(crossed_lines, 1), 2.4);
  ASSERT_TRUE(outline);
  const auto found = [&](double share) {
    const auto picture = visible_part(share);
    return search_print(picture.view(), upright(), {print()}, *outline, {1, [](auto) { return false; }});
  };
  EXPECT_TRUE(found(0.8));
  EXPECT_FALSE(found(0.3));
}

}  // namespace
}  // namespace moiregauge::internal
