// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/frame/track.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/observation/frame/disc_centre.h"
#include "moiregauge/observation/frame/small_rig_for_tests.h"

namespace moiregauge::internal {
namespace {

using test::as_at_rest, test::marker_of, test::SmallRig;

const SmallRig& rig() {
  static const SmallRig one(*simulator::built_in("small-1xyz"));
  return one;
}

// Frame 2: 0.02 deg and 0.1 mm after the reference frame. Tracking and detection read the same gratings. Detection
// starts a hundredth of a pixel away.
TEST(Track, AgreesWithDetection) {
  const Reference& reference = rig().reference;
  const auto now = rig().picture(2);
  const GreyPicture picture{now.view(), 8};
  const Prediction prediction = as_at_rest(reference);
  const auto seen = track_references(picture, reference, prediction);
  ASSERT_TRUE(seen);
  const Observation long_way = observe_board(picture, reference, prediction, kMinForHomography);
  for (const CirclePoint& point : reference.circles) {
    const std::size_t i = point.marker;
    const RasterPlan& plan = reference.plans[i];
    const double px = reference.view.mm_per_px(point.board);
    const auto& rest = reference.seen.markers[i].patch;
    EXPECT_LT(length(seen->markers[i].circle->centre - long_way.markers[i].circle->centre), 0.1);
    // Positions by stage 2, each in its own first view.
    const auto at = [&](const Observation& o) {
      return o.stage1(point.board + displacement_between(plan, rest, o.markers[i].patch));
    };
    // The raster of about 60 px reads to 0.004 px at a noise of 1.5 grey levels, the template to 0.001 px.
    EXPECT_LT(length(at(*seen) - at(long_way)), 0.02) << reference.site.markers[i].name << ' ' << px;
    EXPECT_NEAR(seen->markers[i].patch.modulation[0] / long_way.markers[i].patch.modulation[0], 1.0, 0.02);
    EXPECT_NEAR(seen->markers[i].patch.gradient[0][1], long_way.markers[i].patch.gradient[0][1], 2e-3);
  }
}

TEST(Track, ATargetIsWhereItWent) {
  const Reference& reference = rig().reference;
  const auto now = rig().picture(2);
  const auto target = reference.site.markers.size() - 1;
  const auto seen = track_references({now.view(), 8}, reference, as_at_rest(reference));
  ASSERT_TRUE(seen);
  const auto marker = track_target({{now.view(), 8}, {seen->stage2, {}}}, reference, target, as_at_rest(reference));
  ASSERT_TRUE(marker);
  // The paper's motion is 0.5 mm/s at 10 frames/s. With an ideal lens and 0.02 deg only noise remains, below a
  // micrometre.
  EXPECT_NEAR(marker->window_shift.y, 0.1, 0.005);
  EXPECT_NEAR(marker->window_shift.x, 0.0, 0.005);
}

TEST(Track, AnOccludedReferenceGoesThroughDetection) {
  simulator::Scenario covered = rig().scenario;
  covered.markers.front().cover.frames = {{2, 3}};
  covered.markers.front().cover.share = 0.5;
  const auto now = SmallRig::rendered(covered, 2);
  EXPECT_FALSE(track_references({now.view(), 8}, rig().reference, as_at_rest(rig().reference)));
}

// Half a pitch from the position that the circles imply, two lattice lines are equally near. Tracking reads one of them
// without its outline. A reference on the wrong line would displace every target, so a third of a pitch is too far.
TEST(Track, AReferenceAThirdOfAPitchFromItsCircleGoesThroughDetection) {
  const auto is_tracked = [](double pitches) {
    simulator::Scenario apart = rig().scenario;
    Grating& grating = *marker_of(apart, "NE").print.grating;
    grating.centre.y += pitches * grating.pitch_mm;
    const auto now = SmallRig::rendered(apart, 2);
    return track_references({now.view(), 8}, rig().reference, as_at_rest(rig().reference)).has_value();
  };
  EXPECT_TRUE(is_tracked(0.2));
  EXPECT_FALSE(is_tracked(0.33));
}

// Returns a disc of 40 px, lit from one side.
constexpr ImagePoint kDisc{58.3, 61.8};
Image<std::uint8_t> disc_picture(double contrast) {
  Image<std::uint8_t> picture(120, 120, 210);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 120; ++x) {
      const double inside = std::clamp(20.0 - std::hypot(x - kDisc.x, y - kDisc.y) + 0.5, 0.0, 1.0);
      picture.at(x, y) = static_cast<std::uint8_t>(std::lround(210.0 + contrast * inside - 0.2 * x));
    }
  }
  return picture;
}

TEST(DiscCentre, IsWithinATwentiethOfAPixelAndOnlyWhereADiscIs) {
  const auto picture = disc_picture(-160.0);
  DetectedCircle like;
  like.contrast = -160.0;
  const auto found = disc_centre(picture.view(), {64.0, 58.0}, 40.0, like);
  ASSERT_TRUE(found);
  // Light that falls by s per pixel displaces the centroid of a window of radius R by (pi R^4 / 4) s over the disc's
  // weight.
  constexpr double kReach = 25.0, kRadius = 20.0;
  EXPECT_LT(length(*found - kDisc), 0.05 + std::pow(kReach, 4) / (4.0 * kRadius * kRadius) * 0.2 / 160.0);
  EXPECT_FALSE(disc_centre(picture.view(), {64.0, 58.0}, 36.0, like)) << "too small";
  EXPECT_FALSE(disc_centre(picture.view(), {20.0, 20.0}, 40.0, like)) << "paper";
  like.contrast = 160.0;
  EXPECT_FALSE(disc_centre(picture.view(), {64.0, 58.0}, 40.0, like)) << "a light disc was asked for";
}

// The edge of the paper's ring does not reach the disc here, so its area is measured whole.
TEST(DiscCentre, OfAnotherAreaOrContrastIsNotTheSameDisc) {
  DetectedCircle like;
  like.contrast = -160.0;
  EXPECT_TRUE(disc_centre(disc_picture(-160.0).view(), kDisc, 40.0, like));
  EXPECT_FALSE(disc_centre(disc_picture(-160.0).view(), kDisc, 43.0, like)) << "its area is 13 % too small";
  EXPECT_TRUE(disc_centre(disc_picture(-80.0).view(), kDisc, 40.0, like)) << "half the light";
  EXPECT_FALSE(disc_centre(disc_picture(-48.0).view(), kDisc, 40.0, like)) << "a shadow";
}

}  // namespace
}  // namespace moiregauge::internal
