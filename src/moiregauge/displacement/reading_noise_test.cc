// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/reading_noise.h"

#include <cmath>
#include <cstdint>
#include <random>

#include <gtest/gtest.h>

#include "moiregauge/displacement/five_markers_for_tests.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr std::uint32_t kSeed = 5;

// Frames whose slopes have `excess` times the noise of independent pixels, about a slope of their own.
Observations noisy_frames(const Reference& reference, int count, double excess) {
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  Observations frames(reference);
  for (int n = 0; n < count; ++n) {
    Observation seen = reference.seen;
    seen.frame = n;
    for (std::size_t i = 0; i < seen.markers.size(); ++i) {
      const RasterPlan& plan = reference.plans[i];
      const double u = excess * slope_noise_per_mean(plan) * test::kPhase_rad * plan.pitch_mm / kTwoPi / plan.step_mm;
      for (auto& along : seen.markers[i].patch.gradient)
        for (double& slope : along) slope = 0.002 + u * normal(random);
    }
    frames.push_back(seen);
  }
  return frames;
}

TEST(ReadingNoise, TheSlopeOfIndependentPixelsHasItsClosedForm) {
  // With a window much smaller than the region, a region is a row of n independent values at x. Then
  // u_slope / u_mean = sqrt(n / sum x^2) = sqrt(12 / (n^2 - 1)).
  RasterPlan plan;
  plan.sampling_pitch_px = 1;
  plan.region_px = 200;
  EXPECT_NEAR(slope_noise_per_mean(plan) * std::sqrt((200.0 * 200.0 - 1.0) / 12.0), 1.0, 0.01);
  // With a triangle of half width T much larger than the region, a pixel's weight in the slope is that of the triangle's
  // slope, +-1. The mean has the triangle itself. Sums over the pixels: 2 T, and 2 T^3 / 3. The ratio is sqrt(3) / T.
  plan.sampling_pitch_px = 2000;
  plan.region_px = 100;
  EXPECT_NEAR(slope_noise_per_mean(plan) * 2000.0 / std::sqrt(3.0), 1.0, 0.05);
}

TEST(ReadingNoise, ItsExcessIsThatOfTheSlopes) {
  const Reference reference = test::five_markers(Pattern::kGrid);
  constexpr int kFrames = 40;
  // 4 slopes of 5 gratings in 39 pairs. Successive differences share a frame, so half of them count.
  const double u = 1.2 / std::sqrt(0.5 * 20 * (kFrames - 1));
  EXPECT_EQ(noise_excess(reference, noisy_frames(reference, kFrames, 1.0)), 1.0) << "seed " << kSeed;
  for (const double excess : {2.0, 5.0})
    EXPECT_NEAR(noise_excess(reference, noisy_frames(reference, kFrames, excess)) / excess, 1.0, 3.0 * u)
        << "seed " << kSeed;
}

TEST(ReadingNoise, AFewFramesShowNoExcess) {
  const Reference reference = test::five_markers(Pattern::kGrid);
  EXPECT_EQ(noise_excess(reference, noisy_frames(reference, 5, 5.0)), 1.0);
  EXPECT_EQ(noise_excess(reference, noisy_frames(reference, 1, 5.0)), 1.0);
  EXPECT_EQ(noise_excess(reference, Observations(reference)), 1.0);
}

// In a live run the software of the camera may begin to smooth, and stop.
TEST(ReadingNoise, TheLatestSlopesDecide) {
  const Reference reference = test::five_markers(Pattern::kGrid);
  constexpr int kFrames = 40;
  ReadingNoise noise(reference, 20 * (kFrames - 1));
  const auto add = [&](double excess) {
    noise.forget_frame();
    const Observations frames = noisy_frames(reference, kFrames, excess);
    for (std::size_t n = 0; n < frames.size(); ++n) noise.add(frames[n]);
    return noise.excess();
  };
  EXPECT_EQ(add(1.0), 1.0) << "seed " << kSeed;
  EXPECT_NEAR(add(3.0), 3.0, 3.0 * 3.0 * 1.2 / std::sqrt(0.5 * 20 * (kFrames - 1))) << "seed " << kSeed;
  EXPECT_EQ(add(1.0), 1.0) << "seed " << kSeed;
}

TEST(ReadingNoise, UOfARowContainsIt) {
  const Reference reference = test::five_markers(Pattern::kGrid);
  const auto u_of = [&](double excess) {
    const Solution solution = solve_conventional(reference, noisy_frames(reference, 40, excess), {});
    EXPECT_EQ(solution.notes.empty(), excess == 1.0);
    return solution.samples.back().budget.noise.x;
  };
  EXPECT_NEAR(u_of(3.0) / u_of(1.0), 3.0, 3.0 * 3.0 * 1.2 / std::sqrt(0.5 * 20 * 39)) << "seed " << kSeed;
}

}  // namespace
}  // namespace moiregauge::internal
