// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/comparison/comparison.h"

#include <array>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "moiregauge/results/comparison/records_for_tests.h"

namespace moiregauge::internal {
namespace {

using test::RecordPlan;
using test::simulated_records;

Comparison compared(const RecordPlan& plan, std::uint64_t seed, std::optional<double> offset_s = {}) {
  const auto records = simulated_records(plan, seed);
  auto comparison = compare_records(records.channel, records.reference, offset_s);
  EXPECT_TRUE(comparison) << "seed " << seed << ": " << (comparison ? "" : comparison.error().what);
  return comparison ? *std::move(comparison) : Comparison{};
}

// Errors of the four estimates in their u, over many draws of noise.
struct AlignmentPulls {
  std::array<double, 4> squares{}, outside{};
  double max_offset_error_s = 0.0;
  int draws = 0;
  void add(const RecordPlan& plan, const Comparison& c) {
    const Alignment& a = c.alignment;
    // The truth of the bias is that of the mean reference, so a slope other than 1 would enter.
    const std::array errors{a.offset_s.value - plan.offset_s, a.rate.value - plan.rate, a.slope.value - plan.slope,
                            a.bias.value - plan.bias_mm};
    const std::array us{a.offset_s.u, a.rate.u, a.slope.u, a.bias.u};
    for (std::size_t i = 0; i < 4; ++i) {
      const double pull = errors[i] / us[i];
      squares[i] += pull * pull;
      outside[i] += std::abs(pull) > 1.96 ? 1.0 : 0.0;
    }
    max_offset_error_s = std::max(max_offset_error_s, std::abs(errors[0]));
    ++draws;
  }
  // The rms of n pulls has a relative standard error of 1 / sqrt(2 n); `bias` is that of the covariance itself.
  void check(double bias) const {
    constexpr std::array names{"offset", "rate", "slope", "bias"};
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(std::sqrt(squares[i] / draws), 1.0, bias + 3.5 / std::sqrt(2.0 * draws)) << names[i];
      const double share = outside[i] / draws, expected = 0.05;
      std::printf("%s: %.0f of %d draws within 1.96 u, rms %.2f u\n", names[i], draws - outside[i], draws,
                  std::sqrt(squares[i] / draws));
      EXPECT_LE(share, expected + bias + 3.5 * std::sqrt(expected * (1.0 - expected) / draws)) << names[i];
    }
  }
};

TEST(Comparison, TheOffsetOfAnLvdtIsWithinItsUncertainty) {
  const RecordPlan plan;
  AlignmentPulls pulls;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const Comparison c = compared(plan, seed);
    pulls.add(plan, c);
    EXPECT_TRUE(c.alignment.has_rate);
  }
  // u of the offset: 5 um of noise over sqrt(300) rows of 2 mm/s rms gives 0.15 ms.
  EXPECT_LT(pulls.max_offset_error_s, 1e-3);
  pulls.check(0.03);
}

// Interpolation averages noise most between two samples. Least squares would prefer such offsets.
TEST(Comparison, ANoisyReferenceDoesNotPullTheOffsetBetweenItsSamples) {
  RecordPlan plan;
  plan.reference_noise_mm = 0.05;
  plan.duration_s = 120.0;
  AlignmentPulls pulls;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) pulls.add(plan, compared(plan, seed));
  pulls.check(0.05);
}

TEST(Comparison, AutocorrelatedErrorsWidenTheUncertainty) {
  RecordPlan plan;
  plan.autocorrelation = 0.6;
  plan.duration_s = 60.0;
  AlignmentPulls pulls;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) pulls.add(plan, compared(plan, seed));
  pulls.check(0.12);  // Bartlett's weights lose 10 % of u at this autocorrelation
}

TEST(Comparison, ASlowReferenceIsComparedAtItsOwnTimes) {
  RecordPlan plan;
  plan.frame_s = 1.0 / 30.0;
  plan.reference_s = 0.2;
  plan.duration_s = 60.0;
  AlignmentPulls pulls;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const Comparison c = compared(plan, seed);
    EXPECT_TRUE(c.alignment.is_channel_interpolated);
    pulls.add(plan, c);
  }
  pulls.check(0.05);
}

// A record of 4 s has 40 rows, and its rate is fixed at 0. The clock's rate of 40 ppm is within the u of a fixed rate.
TEST(Comparison, TheUncertaintyOfAShortRecordHolds) {
  RecordPlan plan;
  plan.duration_s = 4.0;
  constexpr int kDraws = 400;
  std::array<double, 3> squares{}, outside{};
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    const Alignment a = compared(plan, seed).alignment;
    const std::array pulls{(a.offset_s.value - plan.offset_s) / a.offset_s.u, (a.slope.value - plan.slope) / a.slope.u,
                           (a.bias.value - plan.bias_mm) / a.bias.u};
    for (std::size_t i = 0; i < pulls.size(); ++i) {
      squares[i] += pulls[i] * pulls[i];
      outside[i] += std::abs(pulls[i]) > 2.0 ? 1.0 : 0.0;
    }
  }
  // With 37 degrees of freedom 5.3 % of Student's distribution are beyond 2, and its rms is 1.03. Standard errors of a
  // share and of an rms over 400 draws: 1.1 % and 0.035. Three of them are allowed.
  for (std::size_t i = 0; i < squares.size(); ++i) {
    EXPECT_LE(outside[i] / kDraws, 0.053 + 0.033) << i;
    EXPECT_LE(std::sqrt(squares[i] / kDraws), 1.03 + 0.105) << i;
  }
}

TEST(Comparison, TheSlopeIsTheRatioOfTheMovements) {
  RecordPlan plan;
  plan.slope = 1.02;
  const Comparison c = compared(plan, 3);
  EXPECT_NEAR(c.alignment.slope.value, 1.02, 4.0 * c.alignment.slope.u);
  EXPECT_LT(c.alignment.slope.u, 0.001);
}

// The offset grows by 6 s over 10 min, which is many periods of the movement.
TEST(Comparison, AClockWithAWrongRateIsFollowedThroughALongRecord) {
  RecordPlan plan;
  plan.duration_s = 600.0;
  plan.rate = 0.001;
  plan.lead_s = 20.0;
  const Comparison c = compared(plan, 5);
  ASSERT_TRUE(c.alignment.has_rate);
  EXPECT_NEAR(c.alignment.rate.value, plan.rate, 4.0 * c.alignment.rate.u);
  EXPECT_LT(c.alignment.rate.u, 1e-5);
  EXPECT_NEAR(c.alignment.offset_s.value, plan.offset_s, 4.0 * c.alignment.offset_s.u);
}

TEST(Comparison, UncertaintyExplainsADifferenceOfNoiseAlone) {
  RecordPlan plan;
  plan.reference_noise_mm = 0.0;
  const Comparison c = compared(plan, 7);
  // The variance of 300 values has a relative standard error of 8 %; three of them.
  EXPECT_NEAR(c.explained, 1.0, 0.25);
  EXPECT_NEAR(c.coverage, 0.954, 3.0 * std::sqrt(0.954 * 0.046 / 300.0));
  EXPECT_NEAR(c.rms_difference, plan.noise_mm, 0.13 * plan.noise_mm);
  EXPECT_NEAR(c.upper_limit - c.lower_limit, 2.0 * 1.96 * plan.noise_mm, 0.5 * plan.noise_mm);
  for (const ComparedRow& row : c.rows) EXPECT_NEAR(row.difference, row.measured - row.reference, 1e-12);
}

TEST(Comparison, AReferenceWithNoiseOfItsOwnLeavesAnUnexplainedPart) {
  RecordPlan plan;
  plan.reference_noise_mm = 0.012;
  const Comparison c = compared(plan, 8);
  EXPECT_LT(c.explained, 0.25);
  EXPECT_LT(c.coverage, 0.7);
  // Interpolated at the samples' own phase, noise keeps between 60 and 100 % of its rms.
  EXPECT_GT(c.rms_unexplained, 0.5 * plan.reference_noise_mm);
  EXPECT_LT(c.rms_unexplained, 1.1 * plan.reference_noise_mm);
}

// A common offset of all rows is part of u, but not of u about the mean.
TEST(Comparison, WhatAllRowsShareDoesNotWidenTheirDifference) {
  auto records = simulated_records({}, 9);
  records.channel.loadings.setConstant(0.1);
  const auto c = compare_records(records.channel, records.reference, {});
  ASSERT_TRUE(c);
  EXPECT_NEAR(c->rms_u, RecordPlan{}.noise_mm, 0.01 * RecordPlan{}.noise_mm);
  EXPECT_NEAR(c->alignment.bias.u_channel, 0.1, 1e-3);
  EXPECT_LT(c->alignment.slope.u_channel, 1e-4);
}

TEST(Comparison, RowsThatAreNotOkAreNotCompared) {
  auto records = simulated_records({}, 10);
  for (std::size_t n = 100; n < 120; ++n)
    records.channel.status[n] = Status::kBlurred, records.channel.value(static_cast<Eigen::Index>(n)) += 5.0;
  records.reference.value[2000] = kNotMeasured;
  const auto c = compare_records(records.channel, records.reference, {});
  ASSERT_TRUE(c);
  EXPECT_EQ(c->rows.size(), 280U);
  EXPECT_LT(c->rms_difference, 0.01);
}

TEST(Comparison, UnrelatedRecordsHaveNoCommonMovement) {
  const auto one = simulated_records({}, 1);
  int accepted = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 rng(seed);
    std::normal_distribution<double> normal;
    Series noise = one.reference;
    for (double& v : noise.value) v = normal(rng);
    const auto c = compare_records(one.channel, noise, {});
    accepted += c ? 1 : 0;
    if (c) continue;
    EXPECT_NE(c.error().what.find("no common movement"), std::string::npos) << c.error().what;
  }
  EXPECT_EQ(accepted, 0);  // expected: 20 times kMaxChance
}

TEST(Comparison, AConstantReferenceIsRefused) {
  auto records = simulated_records({}, 1);
  for (double& v : records.reference.value) v = 3.0;
  const auto c = compare_records(records.channel, records.reference, {});
  ASSERT_FALSE(c);
  EXPECT_NE(c.error().what.find("does not vary"), std::string::npos) << c.error().what;
}

TEST(Comparison, AnOppositeSignIsNamed) {
  auto records = simulated_records({}, 1);
  for (double& v : records.reference.value) v = -v;
  const auto c = compare_records(records.channel, records.reference, {});
  ASSERT_FALSE(c);
  EXPECT_NE(c.error().remedy.find("--sign -1"), std::string::npos);
}

TEST(Comparison, APeriodicMovementIsAmbiguousUnlessTheOffsetIsKnown) {
  auto records = simulated_records({}, 1);
  const RecordPlan plan;
  for (std::size_t n = 0; n < records.channel.time_s.size(); ++n)
    records.channel.value(static_cast<Eigen::Index>(n)) = std::sin(kTwoPi * 0.5 * records.channel.time_s[n]);
  for (std::size_t n = 0; n < records.reference.time_s.size(); ++n)
    records.reference.value[n] = std::sin(kTwoPi * 0.5 * (records.reference.time_s[n] - plan.offset_s));
  const auto searched = compare_records(records.channel, records.reference, {});
  ASSERT_TRUE(searched);
  ASSERT_FALSE(searched->warnings.empty());
  EXPECT_NE(searched->warnings.front().find("--offset"), std::string::npos);
  const auto stated = compare_records(records.channel, records.reference, 0.1);
  ASSERT_TRUE(stated);
  EXPECT_NEAR(stated->alignment.offset_s.value, plan.offset_s, 1e-5);
}

TEST(Comparison, AnOffsetWithoutOverlapIsRefused) {
  const auto records = simulated_records({}, 1);
  const auto c = compare_records(records.channel, records.reference, 1000.0);
  ASSERT_FALSE(c);
  EXPECT_NE(c.error().what.find("in common"), std::string::npos) << c.error().what;
}

TEST(Comparison, AShortRecordDoesNotDetermineTheRate) {
  RecordPlan plan;
  plan.duration_s = 4.0;
  plan.rate = 0.0;
  plan.noise_mm = 0.02;
  const Comparison c = compared(plan, 11);
  EXPECT_FALSE(c.alignment.has_rate);
  EXPECT_EQ(c.alignment.rate.value, 0.0);
  EXPECT_NEAR(c.alignment.offset_s.value, plan.offset_s, 4.0 * c.alignment.offset_s.u);
}

}  // namespace
}  // namespace moiregauge::internal
