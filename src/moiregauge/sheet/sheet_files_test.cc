// SPDX-License-Identifier: Apache-2.0
// The content of the files. tests/cli/sheet measures their printed size.
#include "moiregauge/sheet/sheet_files.h"

#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/sheet/draw_tile.h"

namespace moiregauge::internal::sheet {
namespace {

PageRequest on(const char* paper) { return {*standard_paper(paper), Orientation::kAuto, Together::kWhereTheyFit}; }

Site site_in(double width, double height) {
  SetRequest request;
  request.span = {width, height};
  return *site_of_set(request);
}

TEST(SheetSet, MarkersShareASheetIfTheyFit) {
  EXPECT_EQ(sheets_of(site_in(340.0, 180.0), on("A3"))->sheets.size(), 1u);
  EXPECT_EQ(sheets_of(site_in(340.0, 180.0), on("A4"))->sheets.size(), 5u);
}

// Points higher on the board are nearer to the page's upper edge, at scale 1:1.
TEST(SheetSet, APageKeepsDistancesAndDirections) {
  const auto set = sheets_of(site_in(340.0, 180.0), on("A3"));
  const Sheet& sheet = set->sheets.front();
  const PagePoint low = on_page(sheet, {-170.0, -90.0}), high = on_page(sheet, {170.0, 90.0});
  EXPECT_NEAR(high.x_mm - low.x_mm, 340.0, 1e-9);
  EXPECT_NEAR(low.y_mm - high.y_mm, 180.0, 1e-9);
}

SetRequest large_set(double pitch_mm) {
  SetRequest request;
  request.span = {33.0 * pitch_mm, 25.0 * pitch_mm};
  request.pitch_mm = pitch_mm;
  return request;
}

TEST(SheetSet, PartsOfALargeMarkerCoverItAndOverlap) {
  const auto set = sheets_of(*site_of_set(large_set(60.0)), on("A4"));
  ASSERT_TRUE(set);
  for (const Sheet& sheet : set->sheets) {
    ASSERT_TRUE(sheet.tiling) << sheet.name;
    const Tiling& tiling = *sheet.tiling;
    const auto room = room_on(tiling.paper), whole = room_on(sheet.paper);
    EXPECT_LE(tiling.width_mm, room.x);
    EXPECT_LE(tiling.height_mm, room.y);
    // The last part ends where the area ends, and each one begins before the one before it ends.
    const PagePoint last = corner_of_tile(tiling, tiling.columns - 1, tiling.rows - 1);
    EXPECT_NEAR(last.x_mm + tiling.width_mm, whole.x, 1e-9);
    EXPECT_NEAR(last.y_mm + tiling.height_mm, whole.y, 1e-9);
    EXPECT_NEAR(corner_of_tile(tiling, 1, 0).x_mm, tiling.width_mm - kTileOverlap_mm, 1e-9);
    // One column or row less would not hold it.
    EXPECT_GT(whole.x, tiling.columns > 1 ? (tiling.columns - 1) * (room.x - kTileOverlap_mm) + kTileOverlap_mm : 0.0);
    const Box box = extent_of(sheet.markers);
    EXPECT_NEAR(whole.x, box.width() + 2.0 * sheet.cut_mm, 1e-9);
  }
}

TEST(SheetSet, AMarkerOfTooManyPartsIsRefusedWithBothSizes) {
  const auto set = sheets_of(*site_of_set(large_set(400.0)), on("A4"));
  ASSERT_FALSE(set);
  EXPECT_NE(set.error().find("A4 has room for"), std::string::npos) << set.error();
  SetRequest cosine = large_set(60.0);
  cosine.pattern = Pattern::kCosine;
  const auto grey = sheets_of(*site_of_set(cosine), on("A4"));
  ASSERT_FALSE(grey);
  EXPECT_NE(grey.error().find("cosine"), std::string::npos) << grey.error();
}

TEST(SheetSet, PaperFollowsTheMarkersUnlessItsOrientationIsGiven) {
  PageRequest page = on("A4");
  EXPECT_GT(sheets_of(site_in(760.0, 300.0), page)->sheets.front().paper.width_mm,
            250.0);  // circle next to grating: wide
  page.orientation = Orientation::kPortrait;
  EXPECT_LT(oriented(page, true).width_mm, 250.0);
}

TEST(SheetFiles, TheSameSetGivesTheSameBytesWithoutADate) {
  const auto set = sheets_of(site_in(340.0, 180.0), on("A3"));
  const SheetFiles one = files_of(*set, {}, ""), two = files_of(*set, {}, "");
  EXPECT_TRUE(one.pdf == two.pdf);  // too long for EXPECT_EQ to print
  EXPECT_TRUE(one.plan == two.plan);
  EXPECT_TRUE(one.svg == two.svg);
  EXPECT_EQ(one.pdf.find("CreationDate"), std::string::npos);
}

TEST(SheetFiles, SvgUnitsAreMillimetres) {
  const auto set = sheets_of(site_in(340.0, 180.0), on("A3"));
  const std::string svg = files_of(*set, {}, "").svg.front().second;
  EXPECT_NE(svg.find("width=\"420mm\" height=\"297mm\" viewBox=\"0 0 420 297\""), std::string::npos);
}

TEST(SheetFiles, MarkerNamesBecomeValidFileNames) {
  Site site = site_in(760.0, 300.0);
  site.markers[0].name = "a/b";
  site.markers[1].name = "a b";
  const auto files = files_of(*sheets_of(site, on("A4")), {}, "");
  EXPECT_EQ(files.svg[0].first, "a_b");
  EXPECT_EQ(files.svg[1].first, "a_b_");
}

// The symmetry point is the lightest point, and the grating spans the whole range of greys.
TEST(CosineGrating, ACrestIsWhiteATroughIsBlack) {
  EXPECT_NEAR(cosine_grey(0.0, 0.0, {}), 1.0, 1e-12);
  EXPECT_NEAR(cosine_grey(0.5, 0.5, {}), 0.0, 1e-12);
  EXPECT_NEAR(cosine_grey(0.0, 0.5, {}), 0.5, 1e-12);
  EXPECT_NEAR(std::pow(cosine_grey(0.0, 0.5, {1.0, false, 2.2}), 2.2), 0.5, 1e-12);  // a wave in light
}

}  // namespace
}  // namespace moiregauge::internal::sheet
