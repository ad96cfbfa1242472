// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/run/repeated_frames.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

Image<std::uint8_t> picture(int changed_x) {
  Image<std::uint8_t> made(37, 50);
  for (int y = 0; y < 50; ++y) {
    for (int x = 0; x < 37; ++x) made.row(y)[static_cast<std::size_t>(x)] = static_cast<std::uint8_t>(3 * x + 5 * y);
  }
  if (changed_x >= 0) ++made.row(24)[static_cast<std::size_t>(changed_x)];
  return made;
}

TEST(RepeatedFrames, DifferFromFramesWithOneChangedPixelInAComparedRow) {
  const auto same = picture(-1);
  for (int x = 0; x < 37; ++x) {
    RepeatedFrames frames;
    const auto other = picture(x);
    EXPECT_FALSE(frames.repeats(LumaView(same.view())));
    EXPECT_TRUE(frames.repeats(LumaView(same.view())));
    EXPECT_FALSE(frames.repeats(LumaView(other.view()))) << x;
    EXPECT_FALSE(frames.repeats(LumaView(same.view())));
  }
}

}  // namespace
}  // namespace moiregauge::internal
