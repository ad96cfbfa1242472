// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/overlays/overlay_inspection.h"

#include <gtest/gtest.h>

#include "moiregauge/drawing/overlays/inspection_text.h"

namespace moiregauge::internal {
namespace {

struct Size {
  int width = 0, height = 0;
};

// Reads the size from the PNG header.
Size size_of(const std::vector<std::uint8_t>& png) {
  const auto number = [&](std::size_t at) {
    return png[at] << 24 | png[at + 1] << 16 | png[at + 2] << 8 | png[at + 3];
  };
  return png.size() < 24 ? Size{} : Size{number(16), number(20)};
}

Inspection one_rejected() {
  Inspection seen;
  seen.missing = "four circles are needed";
  seen.rejected = {{{20.0, 30.0}, 15.0, 0.79, "W = 0.79, need > 0.84"}};
  return seen;
}

TEST(InspectionOverlay, ASmallImageIsEnlargedToFitLabels) {
  const Image<std::uint8_t> small(640, 480, 90), large(4104, 1012, 90);
  const Inspection seen = one_rejected();
  const Size of_small = size_of(draw_inspection({small.view(), seen, {}, "small"}));
  EXPECT_EQ(of_small.width, 2 * 640);
  EXPECT_GT(of_small.height, 2 * 480) << "the legend stands below, not on, the picture";
  const Size of_large = size_of(draw_inspection({large.view(), seen, {}, "large"}));
  EXPECT_EQ(of_large.width, 4104);
  EXPECT_GT(of_large.height, 1012);
}

TEST(InspectionOverlay, DetectedObjectsAreDrawn) {
  const Image<std::uint8_t> picture(640, 480, 90);
  Inspection seen = one_rejected();
  const auto before = draw_inspection({picture.view(), seen, {}, ""});
  InspectedCircle circle;
  circle.seen.centre = {300.0, 200.0};
  circle.seen.diameter_px = 40.0;
  seen.circles.push_back(circle);
  EXPECT_NE(draw_inspection({picture.view(), seen, {}, ""}), before);
}

TEST(InspectionText, OutlinesInsideDetectedObjectsAreNotListed) {
  Inspection seen = one_rejected();
  EXPECT_EQ(rejected_elsewhere(seen).size(), 1U);
  InspectedPatch patch;
  patch.seen.outline = {{{0.0, 0.0}, {100.0, 0.0}, {100.0, 100.0}, {0.0, 100.0}}};
  seen.patches.push_back(patch);
  EXPECT_TRUE(rejected_elsewhere(seen).empty());
}

TEST(InspectionText, ALatticeIsDescribedWithItsDetectedShare) {
  IndexedLattice lattice;
  lattice.columns = lattice.rows = 10;
  lattice.points.resize(99);
  EXPECT_EQ(lattice_text(lattice), "dots 10 x 10, 99 of 100");
}

}  // namespace
}  // namespace moiregauge::internal
