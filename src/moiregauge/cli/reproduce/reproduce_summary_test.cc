// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/reproduce/reproduce_summary.h"

#include <cmath>

#include <gtest/gtest.h>

namespace moiregauge::internal::cli {
namespace {

TEST(ErrorSummary, OfAConstantErrorIsThatError) {
  const ErrorSummary summary = summary_of({-0.2, 0.2, -0.2});
  EXPECT_NEAR(summary.rms, 0.2, 1e-15);
  EXPECT_EQ(summary.largest, 0.2);
}

TEST(ErrorSummary, LostFramesNeitherHideTheLargestNorDiluteTheRms) {
  const ErrorSummary summary = summary_of({3.0, std::nan(""), -4.0, std::nan("")});
  EXPECT_NEAR(summary.rms, std::sqrt(12.5), 1e-15);
  EXPECT_EQ(summary.largest, 4.0);
  EXPECT_EQ(summary.lost, 2U);
}

TEST(ErrorSummary, WithoutValuesIsNotZero) {
  for (const auto& run : {std::vector<double>{}, std::vector<double>{std::nan("")}}) {
    EXPECT_TRUE(std::isnan(summary_of(run).rms));
    EXPECT_TRUE(std::isnan(summary_of(run).largest));
  }
}

}  // namespace
}  // namespace moiregauge::internal::cli
