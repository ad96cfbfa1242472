// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/image/quantiser.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

TEST(Quantiser, SixParametersDoubleTheStep) {
  for (int parameter = 0; parameter + 6 <= kMaxParameter; ++parameter)
    EXPECT_NEAR(step_of_parameter(parameter + 6) / step_of_parameter(parameter), 2.0, 1e-12);
  EXPECT_NEAR(step_of_parameter(24), 10.0, 1e-12);  // ITU-T H.264, table 8-15 and equation 8-317
}

TEST(Quantiser, AStepIsKeptToHalfAParameter) {
  for (double step = 0.7; step < 5000.0; step *= 1.13)
    EXPECT_NEAR(std::log2(step_of_parameter(parameter_of_step(step)) / step), 0.0, 0.5 / 6.0 + 1e-9) << step;
}

class AMap : public ::testing::Test {
 protected:
  // Four by three blocks: parameter 10, but 34 in the last column.
  std::vector<std::uint8_t> parameters = {10, 10, 10, 34, 10, 10, 10, 34, 10, 10, 10, 34};
  QuantiserMap map{{7.0, true}, {parameters.data(), 4, 3, 4}};
};

TEST_F(AMap, ARectangleWithinOneBlockHasItsStep) {
  EXPECT_DOUBLE_EQ(map.within(50.0, 20.0, 60.0, 30.0).step, step_of_parameter(34));
  EXPECT_DOUBLE_EQ(map.within(17.0, 17.0, 30.0, 30.0).step, step_of_parameter(10));
  EXPECT_TRUE(map.within(17.0, 17.0, 30.0, 30.0).predicted);
}

TEST_F(AMap, AQuarterOfCoarseBlocksDoesNotDecideAHalfDoes) {
  EXPECT_DOUBLE_EQ(map.within(0.0, 0.0, 63.0, 47.0).step, step_of_parameter(10));
  EXPECT_DOUBLE_EQ(map.within(32.0, 0.0, 63.0, 47.0).step, step_of_parameter(34));
}

TEST_F(AMap, ARectangleBeyondTheImageIsClipped) {
  EXPECT_DOUBLE_EQ(map.within(-500.0, -500.0, 5.0, 5.0).step, step_of_parameter(10));
  EXPECT_DOUBLE_EQ(map.within(60.0, 40.0, 1e9, 1e9).step, step_of_parameter(34));
}

TEST_F(AMap, WithoutBlocksOrWithoutLossTheWholeCounts) {
  EXPECT_DOUBLE_EQ((QuantiserMap{{7.0, true}, {}}.within(0, 0, 9, 9).step), 7.0);
  map.whole.step = 0.0;
  EXPECT_TRUE(map.within(50.0, 20.0, 60.0, 30.0).is_lossless());
  map.whole.step = kUnknownStep;
  EXPECT_TRUE(std::isnan(map.within(50.0, 20.0, 60.0, 30.0).step));
}

TEST(Quantiser, AJpegStepIgnoresTheMeanAndTheFinestEntries) {
  std::array<std::uint16_t, 64> table{};
  table.fill(200);
  table[0] = 3;
  for (std::size_t k = 1; k <= 20; ++k) table[k] = 16;
  EXPECT_DOUBLE_EQ(step_of_jpeg_table(table), 16.0);
}

}  // namespace
}  // namespace moiregauge::internal
