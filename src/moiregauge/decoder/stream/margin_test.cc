// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/stream/margin.h"

#include <string>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

// Input: 'x' is a damaged frame, '|' is damage between frames. Output: 'x' for every spoilt frame.
std::string through(const std::string& frames) {
  DamageMargin<std::size_t> margin;
  std::string out;
  const auto take = [&](const std::pair<std::size_t, bool>& frame) {
    EXPECT_EQ(frame.first, out.size()) << "in order";
    out += frame.second ? 'x' : '.';
  };
  std::size_t number = 0;
  for (const char frame : frames) {
    if (frame == '|') {
      margin.spoil_around();
    } else if (const auto old = margin.put(number++, frame == 'x')) {
      take(*old);
    }
  }
  for (const auto& frame : margin.rest()) take(frame);
  return out;
}

TEST(DamageMargin, ThreeFramesOnEitherSideOfADamagedOneAreSpoilt) {
  EXPECT_EQ(through("............"), "............");
  EXPECT_EQ(through("......x....."), "...xxxxxxx..");
  EXPECT_EQ(through("x..........."), "xxxx........");
  EXPECT_EQ(through("...........x"), "........xxxx");
  EXPECT_EQ(through("....x..x...."), ".xxxxxxxxxx.");
  EXPECT_EQ(through("x........x.."), "xxxx..xxxxxx");
  EXPECT_EQ(through("x"), "x");
  EXPECT_EQ(through(""), "");
  EXPECT_EQ(through("......|......"), "...xxxxxx...");
  EXPECT_EQ(through(".....|"), "..xxx");
}

}  // namespace
}  // namespace moiregauge::internal
