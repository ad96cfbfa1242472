// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/surface/side_by_side.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

// A quarter of 40 mm is 10 mm: 5 times 2 mm, or 200 times 0.05 mm.
TEST(BestExaggeration, MovesNoTargetByMoreThanAQuarterOfItsSize) {
  EXPECT_EQ(best_exaggeration(2.0, 0.001, 40.0), 5.0);
  EXPECT_EQ(best_exaggeration(0.05, 0.001, 40.0), 200.0);
  EXPECT_EQ(best_exaggeration(30.0, 0.001, 40.0), 1.0);
}

// A target at rest moves by its uncertainty: 20 µm may become 2 mm, a twentieth of 40 mm.
TEST(BestExaggeration, DoesNotTurnNoiseIntoMotion) {
  EXPECT_EQ(best_exaggeration(0.001, 0.02, 40.0), 100.0);
  EXPECT_EQ(best_exaggeration(0.0, 0.02, 40.0), 1.0);
}

// Two white squares on a black board at 2 px/mm. The target's is drawn at N d, the reference's is at rest.
TEST(SideBySide, MovesTheTargetAndNothingElse) {
  Reference reference;
  reference.width = 200;
  reference.height = 100;
  Matrix3 h;
  h << 2.0, 0.0, 50.0, 0.0, -2.0, 50.0, 0.0, 0.0, 1.0;  // board (0, 0) at pixel (50, 50), y upwards
  reference.view = {IdealFromBoard(h), {}};
  const auto marker = [](Role role, double x) {
    Marker m;
    m.role = role;
    m.grating = Grating{{x, 0.0}, 10.0, 10.0, 1.0};
    return m;
  };
  reference.site.markers = {marker(Role::kReference, 50.0), marker(Role::kTarget, 0.0)};
  // In the recorded frame the target has moved by 1 mm = 2 px to the right.
  Image<std::uint8_t> filmed(200, 100, 0);
  const auto paint = [&](int x0) {
    for (int y = 40; y <= 60; ++y)
      for (int x = x0 - 10; x <= x0 + 10; ++x) filmed.at(x, y) = 200;
  };
  paint(52);
  paint(150);
  const SideBySide drawn(reference, 5.0, 1.0);
  ASSERT_EQ(drawn.scale(), 1.0);
  const auto page = drawn.draw(filmed.view(), &reference.view, {{true, {1.0, 0.0}, {1.0, 0.0}}}, "", "");
  const auto at = [&](int x, int y) { return int{page.at(drawn.still_x() + x, drawn.still_y() + y)}; };
  // 5 times 2 px: from 50 to 60, so the square extends from 50 to 70.
  EXPECT_EQ(at(51, 50), 200);
  EXPECT_EQ(at(69, 50), 200);
  EXPECT_EQ(at(60, 41), 200);
  EXPECT_EQ(at(72, 50), 0);
  EXPECT_EQ(at(60, 38), 0);
  for (int x = 140; x <= 160; ++x) EXPECT_EQ(at(x, 50), 200) << x;
  EXPECT_EQ(at(138, 50), 0);
  EXPECT_EQ(at(162, 50), 0);
  // Rows next to the reference are as recorded.
  EXPECT_EQ(page.at(52, drawn.still_y() + 50), 200);
}

}  // namespace
}  // namespace moiregauge::internal
