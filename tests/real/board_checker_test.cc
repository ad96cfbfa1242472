// SPDX-License-Identifier: Apache-2.0
// Two photographs in the paper's layout: four circles around a checkerboard, at 25 and 22 degrees of tilt. The lens has
// a distortion of 1.7 px (tests/real/data/SOURCES.md).
#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/detection/identity/identify_markers.h"
#include "moiregauge/planning/reference_weights.h"
#include "real/real_pictures.h"

namespace moiregauge::internal {
namespace {

TEST(BoardChecker, AllFourDiscsAreFoundAndIdentifiedInBothViews) {
  const Site site = test::real_site("board-checker");
  for (const char* file : {"view1.png", "view2.png"}) {
    const auto picture = test::real_picture("board-checker", file);
    const auto who = identify_first(site, find_circles(view_of(picture), {}));
    ASSERT_TRUE(who) << file << ": " << who.error().reason;
    for (std::size_t i = 0; i < 4; ++i) EXPECT_GE(who->circle_of_marker[i], 0) << file << ", " << site.markers[i].name;
  }
}

TEST(BoardChecker, WithoutALensModelTheNullIsHalfAPixelAndNotTrusted) {
  const Measurement run = test::real_run("board-checker", "two-stage");
  const double null = test::null_px(run);
  RecordProperty("null_px", std::to_string(null));
  EXPECT_GE(null, 0.4);  // px, effect of the lens, which this method does not correct
  EXPECT_LE(null, 0.8);
  EXPECT_EQ(test::second_view(run).status, Status::kUntrusted);
  EXPECT_EQ(run.exit, Exit::kRefused);
  // The error is within 3 u along each axis.
  const Sample& sample = test::second_view(run);
  EXPECT_LE(std::abs(sample.displacement.x), 3.0 * sample.u.x);
  EXPECT_LE(std::abs(sample.displacement.y), 3.0 * sample.u.y);
}

TEST(BoardChecker, WithoutTheSecondStageTheNullIsTwoPixels) {
  // Removes stage 2: the displacements of the patches at the circles, weighted by the layout, are its correction.
  const Measurement run = test::real_run("board-checker", "two-stage");
  const Reference& reference = *run.reference;
  std::vector<BoardPoint> circles;
  for (const CirclePoint& p : reference.circles) circles.push_back(p.board);
  const Sample& sample = test::second_view(run);
  const auto weights = reference_weights(circles, reference.site.markers[sample.marker].grating->centre);
  Extent<frame::Board> mended;
  for (std::size_t k = 0; k < circles.size(); ++k) {
    const std::size_t i = reference.circles[k].marker;
    const auto d =
        displacement_between(reference.plans[i], reference.seen.markers[i].patch, run.observations[1].markers[i].patch);
    mended.x += weights[k](0, 0) * d.x + weights[k](0, 1) * d.y;
    mended.y += weights[k](1, 0) * d.x + weights[k](1, 1) * d.y;
  }
  const double alone = length(sample.displacement + mended) / reference.view.mm_per_px({0.0, 0.0});
  RecordProperty("circles_alone_px", std::to_string(alone));
  EXPECT_GT(alone, 1.5);
  EXPECT_LT(alone, 2.5);
}

}  // namespace
}  // namespace moiregauge::internal
