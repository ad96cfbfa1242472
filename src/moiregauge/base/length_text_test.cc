// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/length_text.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

TEST(LengthText, TheSameLengthInAnyUnitIsTheSameNumber) {
  for (const char* text :
       {"10mm", "1cm", "0.01m", "10000um", "10000 \xc2\xb5m", "10000\xce\xbcm", " 10 mm ", "1e1mm"}) {
    ASSERT_TRUE(length_mm(text)) << text;
    EXPECT_EQ(*length_mm(text), 10.0) << text;
  }
  EXPECT_DOUBLE_EQ(*length_mm("0.4in"), 10.16);
}

TEST(LengthText, ANumberWithoutUnitIsRefusedWithAdvice) {
  ASSERT_FALSE(length_mm("10"));
  EXPECT_EQ(length_mm("10").error(), "\"10\" has no unit, write 10mm (or cm, m, um, in)");
}

TEST(LengthText, TextThatIsNoLengthIsRefused) {
  for (const char* text : {"", "mm", "-1mm", "0mm", "10 furlong", "10,0mm", "nanmm", "infmm", "1e999mm", "10mmm"}) {
    EXPECT_FALSE(length_mm(text)) << text;
  }
}

}  // namespace
}  // namespace moiregauge::internal
