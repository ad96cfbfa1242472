// SPDX-License-Identifier: Apache-2.0
// The content of the files. tests/cli/sheet measures their printed size.
#include "moiregauge/sheet/sheet_files.h"

#include <cmath>

#include <gtest/gtest.h>

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

TEST(SheetSet, AMarkerLargerThanThePaperIsRefusedWithBothSizes) {
  SetRequest request;
  request.span = {2000.0, 1500.0};
  request.pitch_mm = 60.0;
  const auto set = sheets_of(*site_of_set(request), on("A4"));
  ASSERT_FALSE(set);
  EXPECT_NE(set.error().find("A4"), std::string::npos) << set.error();
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
