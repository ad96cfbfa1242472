// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/height_claim.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "moiregauge/calibration/model/travel_for_tests.h"

namespace moiregauge::internal {
namespace {

using test::drawn_from, test::kDepthMm, test::kIdeal, test::kMid, test::kSurveyed, test::kTravelSeed, test::small_rig,
    test::travelling;

// Returns the contradiction of a height stated as `height_mm`. The target is at -30 mm. 0.05 mm is 0.0025 px at the edges.
std::optional<HeightContradiction> height_contradiction_of(double height_mm, double u_size_mm = 0.05) {
  std::mt19937_64 rng(kTravelSeed);
  const auto footage = travelling(drawn_from(kSurveyed, rng), rng);
  const Site site = small_rig(kSurveyed, height_mm);
  const ScenePrior given = scene_prior(site, kIdeal.width, kIdeal.height, std::nullopt);
  return height_contradiction(site, footage.frames, given, calibrate(site, footage.frames, given),
                              std::vector<double>(site.markers.size(), u_size_mm));
}

// The footage shows the ratio of height and distance to 0.3 %. A wrong height would make the focal length wrong by the
// same ratio.
TEST(HeightClaim, AHeightWrongByATenthIsContradicted) {
  EXPECT_FALSE(height_contradiction_of(kDepthMm)) << "seed " << kTravelSeed;
  for (const double wrong_mm : {-27.0, -33.0, 0.0}) {
    const auto found = height_contradiction_of(wrong_mm);
    ASSERT_TRUE(found) << wrong_mm << ", seed " << kTravelSeed;
    EXPECT_EQ(found->marker, kMid);
    EXPECT_EQ(found->stated_mm, wrong_mm);
    EXPECT_NEAR(found->shown_mm, kDepthMm, 4.0 * found->u_shown_mm) << "seed " << kTravelSeed;
    EXPECT_GT(found->error_u, 2.0);
    // A grating of this pitch at the stated height looks as large as one of 10 mm at -30 mm. The print scale is known to
    // 0.0005.
    EXPECT_NEAR(found->pitch_mm / (10.0 * (1200.0 - wrong_mm) / 1230.0), 1.0, 0.002);
  }
}

// Sharpening makes apparent size a poor measure of depth. A height 3 mm off is then within 5 u of 1 mm.
TEST(HeightClaim, IsNotContradictedBySharpenedEdges) {
  EXPECT_TRUE(height_contradiction_of(-33.0, 0.05)) << "seed " << kTravelSeed;
  EXPECT_FALSE(height_contradiction_of(-33.0, 1.0)) << "seed " << kTravelSeed;
}

}  // namespace
}  // namespace moiregauge::internal
