// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/fine_pitch.h"

#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/observation/raster/raster.h"

namespace moiregauge::internal {
namespace {

constexpr double kMmPerPx = 0.5;

Marker print_of(double pitch_px, Pattern pattern, const char* name = "mid") {
  Marker m;
  m.name = name;
  m.grating = Grating{{0.0, 0.0}, 40.0, 40.0, pitch_px * kMmPerPx, 0.0, pattern};
  return m;
}

std::optional<std::string> note_of(std::vector<Marker> markers) {
  View view;
  view.ideal_from_board = IdealFromBoard(Eigen::Vector3d(1.0 / kMmPerPx, -1.0 / kMmPerPx, 1.0).asDiagonal());
  return fine_pitch_note({std::move(markers), {}}, view);
}

bool says(const std::optional<std::string>& note, const char* what) {
  return note && note->find(what) != std::string::npos;
}

TEST(FinePitch, ABinaryPrintIsFineBelowEightPixels) {
  for (const Pattern p : {Pattern::kGrid, Pattern::kSquares, Pattern::kDots, Pattern::kLinesX, Pattern::kAuto}) {
    EXPECT_FALSE(note_of({print_of(8.001, p)})) << word_for(p);
    EXPECT_TRUE(note_of({print_of(7.999, p)})) << word_for(p);
  }
  const auto note = note_of({print_of(7.1, Pattern::kGrid)});
  EXPECT_TRUE(says(note, "the pitch of 'mid' is 7.1 px, and below 8 px")) << note.value_or("none");
  EXPECT_TRUE(says(note, "Move closer")) << note.value_or("none");
}

TEST(FinePitch, ACosineIsFineBelowFourPixels) {
  EXPECT_FALSE(note_of({print_of(4.001, Pattern::kCosine)}));
  EXPECT_TRUE(says(note_of({print_of(3.9, Pattern::kCosine)}), "is 3.9 px, and below 4 px"));
}

// The fundamentals of a checkerboard are on its diagonals: two squares over sqrt 2.
TEST(FinePitch, ACheckerboardCountsByItsDiagonals) {
  EXPECT_FALSE(note_of({print_of(8.001 * std::sqrt(2.0), Pattern::kCheckerboard)}));
  EXPECT_TRUE(note_of({print_of(7.999 * std::sqrt(2.0), Pattern::kCheckerboard)}));
}

TEST(FinePitch, OneLineNamesTheFinestOfMany) {
  const auto note = note_of({print_of(7.5, Pattern::kGrid, "NW"), print_of(6.5, Pattern::kGrid, "mid"),
                             print_of(29.0, Pattern::kGrid, "SE"), print_of(5.0, Pattern::kCosine, "SW")});
  EXPECT_TRUE(says(note, "'mid' is 6.5 px (and 1 more),")) << note.value_or("none");
}

TEST(FinePitch, BelowTwoAndAHalfPixelsNothingIsPlanned) {
  for (const Pattern p : {Pattern::kGrid, Pattern::kCosine}) {
    const auto refused = plan_raster(*print_of(2.499, p).grating, kMmPerPx, {});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error(), RasterFailure::kTooCoarse);
    EXPECT_TRUE(plan_raster(*print_of(2.501, p).grating, kMmPerPx, {}));
  }
}

}  // namespace
}  // namespace moiregauge::internal
