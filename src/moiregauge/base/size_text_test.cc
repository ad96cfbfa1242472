// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/size_text.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

TEST(SizeText, ASizeHasItsUnit) {
  EXPECT_EQ(byte_count("500MB"), 500'000'000U);
  EXPECT_EQ(byte_count("1.5GB"), 1'500'000'000U);
  EXPECT_EQ(byte_count("2TB"), 2'000'000'000'000U);
  for (const char* text : {"", "5", "5 GB", "GB", "-1GB", "0MB", "1e9TB", "nanGB", "5GBs"})
    EXPECT_EQ(byte_count(text), std::nullopt) << text;
}

}  // namespace
}  // namespace moiregauge::internal
