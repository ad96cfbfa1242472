// SPDX-License-Identifier: Apache-2.0
// Lattices on photographs of five rigid boards: all points are indexed, there is no false lattice, and the nulls are
// those of the lens. Values of other programs for comparison: tests/real/data/SOURCES.md.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "real/real_lattices.h"

namespace moiregauge::internal {
namespace {

using test::LatticeNull;
using test::LatticeView;

const std::vector<LatticeView>& views_of(const std::string& set) {
  static std::map<std::string, std::vector<LatticeView>> seen;
  const auto it = seen.find(set);
  if (it != seen.end()) return it->second;
  return seen[set] = test::lattice_views(MOIREGAUGE_SOURCE_DIR "/tests/real/data", test::photo_set(set));
}

struct Nulls {
  double median_px = 0.0, worst_px = 0.0;
};

Nulls nulls_of(const std::vector<LatticeView>& views) {
  std::vector<double> all;
  for (std::size_t i = 1; i < views.size(); ++i) {
    const LatticeNull null = test::null_between(views[0].places, views[i].places);
    if (null.targets > 0) all.push_back(null.rms_px);
  }
  if (all.empty()) return {};
  std::sort(all.begin(), all.end());
  return {0.5 * (all[(all.size() - 1) / 2] + all[all.size() / 2]), all.back()};
}

TEST(HandheldChess, EveryViewShowsItsNineBySixCornersAndNoOtherGrid) {
  for (const LatticeView& view : views_of("handheld-chess")) {
    ASSERT_EQ(view.lattices.size(), 1U) << view.file;
    const IndexedLattice& lattice = view.lattices[0];
    EXPECT_TRUE(lattice.whole()) << view.file;
    EXPECT_EQ(std::max(lattice.columns, lattice.rows), 9) << view.file;
    EXPECT_EQ(std::min(lattice.columns, lattice.rows), 6) << view.file;
    EXPECT_FALSE(view.places.empty()) << view.file;  // its colours identify the corners
  }
}

TEST(HandheldChess, TheNullIsThatOfABarrelLens) {
  const double median = nulls_of(views_of("handheld-chess")).median_px;
  RecordProperty("median_px", std::to_string(median));
  EXPECT_NEAR(median, 1.66, 0.166);
}

TEST(BoardChecker, BothViewsShowSixteenBySixteenCorners) {
  for (const LatticeView& view : views_of("board-checker")) {
    ASSERT_EQ(view.lattices.size(), 1U) << view.file;
    EXPECT_EQ(view.lattices[0].columns, 16);
    EXPECT_EQ(view.lattices[0].points.size(), 256U);
  }
}

TEST(BoardChecker, CornersAndPhaseHaveTheSameNullRelativeToTheDiscs) {
  const auto& views = views_of("board-checker");
  const auto corners = test::null_by_discs(views[0].places, views[1].places, views[0].discs, views[1].discs);
  const auto phases = test::phase_places(views[0], views[1], LatticeKind::kCheckerCorners);
  const auto phase = test::null_by_discs(phases.first, phases.second, views[0].discs, views[1].discs);
  RecordProperty("corners_px", std::to_string(corners.rms_px));
  RecordProperty("phase_px", std::to_string(phase.rms_px));
  EXPECT_NEAR(corners.rms_px, 1.65, 0.165);
  EXPECT_NEAR(phase.rms_px, 1.72, 0.172);
}

TEST(BoardDots, BothViewsAreIndexedAlthoughTheLatticeIsOblique) {
  for (const LatticeView& view : views_of("board-dots")) {
    ASSERT_EQ(view.lattices.size(), 1U) << view.file;
    EXPECT_GE(view.lattices[0].points.size(), 1140U) << view.file;
    EXPECT_FALSE(view.places.empty()) << view.file;
  }
}

TEST(BoardDots, ThePhaseHasANullOfAnEighthOfAPixel) {
  const auto& views = views_of("board-dots");
  const auto phases = test::phase_places(views[0], views[1], LatticeKind::kDots);
  const auto null = test::null_between(phases.first, phases.second);
  RecordProperty("phase_px", std::to_string(null.rms_px));
  EXPECT_GE(null.targets, 300);
  EXPECT_GE(null.rms_px, 0.9 * 0.12);  // px, effect of the lens
  EXPECT_LE(null.rms_px, 1.1 * 0.14);
}

TEST(StereoDots, EveryViewIsIndexedAndMatchedByItsThreeRings) {
  for (const LatticeView& view : views_of("stereo-dots")) {
    ASSERT_EQ(view.lattices.size(), 1U) << view.file;
    EXPECT_GE(view.lattices[0].points.size(), 80U) << view.file;
    EXPECT_FALSE(view.places.empty()) << view.file;
  }
}

TEST(StereoDots, WithALongLensTheNullIsWellBelowTwoTenthsOfAPixel) {
  const Nulls nulls = nulls_of(views_of("stereo-dots"));
  RecordProperty("median_px", std::to_string(nulls.median_px));
  RecordProperty("worst_px", std::to_string(nulls.worst_px));
  EXPECT_GT(nulls.median_px, 0.0);
  EXPECT_LE(nulls.median_px, 0.15);
  EXPECT_LE(nulls.worst_px, 0.19);
}

TEST(RobotCircles, AtLeastNinetyNineOfAHundredDotsInEveryViewAndNoFalseGrid) {
  for (const LatticeView& view : views_of("robot-circles")) {
    ASSERT_EQ(view.lattices.size(), 1U) << view.file;
    const IndexedLattice& lattice = view.lattices[0];
    EXPECT_EQ(lattice.columns, 10) << view.file;
    EXPECT_EQ(lattice.rows, 10) << view.file;
    // In view 2.png the edge of the image cuts off the large dot.
    EXPECT_GE(lattice.points.size(), view.file == "2.png" ? 99U : 100U) << view.file;
  }
}

TEST(RobotCircles, TheNullIsAQuarterOfAPixel) {
  const double median = nulls_of(views_of("robot-circles")).median_px;
  RecordProperty("median_px", std::to_string(median));
  EXPECT_LE(median, 0.28);
}

TEST(CircleTest, AcceptsRealCirclesOfAllSizes) {
  const auto small = test::dots_accepted(views_of("robot-circles"));
  EXPECT_GE(small.there, 1400);
  EXPECT_GE(small.share(), 0.98);
  for (const char* set : {"board-dots", "stereo-dots"}) {
    const auto large = test::dots_accepted(views_of(set));
    EXPECT_GE(large.there, 1000) << set;
    EXPECT_GE(large.share(), 0.995) << set;
  }
}

TEST(CircleTest, RefusesRealSquares) {
  const auto board = test::squares_accepted(views_of("board-checker")),
             hand = test::squares_accepted(views_of("handheld-chess"));
  EXPECT_EQ(board.there + hand.there, 2 * 15 * 15 + 13 * 8 * 5);
  EXPECT_LT(board.accepted + hand.accepted, 0.005 * (board.there + hand.there));
}

TEST(Lattices, ACheckerboardHasNoDotsAndDotsHaveNoCorners) {
  for (const char* set : {"handheld-chess", "board-checker"}) {
    for (const LatticeView& view : views_of(set))
      EXPECT_TRUE(find_dot_lattices(view.circles.circles).empty()) << set << " " << view.file;
  }
  for (const char* set : {"robot-circles", "board-dots"}) {
    for (const LatticeView& view : views_of(set))
      EXPECT_TRUE(find_checker_lattices(view_of(view.picture), view.picture.bits).empty()) << set << " " << view.file;
  }
}

}  // namespace
}  // namespace moiregauge::internal
