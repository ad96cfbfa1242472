// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/frame/slipped_circle.h"

#include <cmath>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

constexpr double kPxPerMm = 3.0;
constexpr double kHalfDiagonal_px = 1000.0;

// Returns the ideal view of a board whose camera was shifted by `moved_px`.
IdealFromBoard upright(double moved_px) {
  Matrix3 h;
  h << kPxPerMm, 0, moved_px, 0, -kPxPerMm, 0, 0, 0, 1;
  return IdealFromBoard(h);
}

// Radial distortion about the middle of the image, relative at the half diagonal.
IdealPoint bent(IdealPoint p, double distortion) {
  const double r2 = (p.x * p.x + p.y * p.y) / (kHalfDiagonal_px * kHalfDiagonal_px);
  return {p.x * (1.0 + distortion * r2), p.y * (1.0 + distortion * r2)};
}

// Six references through a lens that the instrument does not know, in the reference frame and after a pan.
struct Wall {
  Reference reference;
  std::vector<CirclePoint> points;
  Wall(double distortion, double pan_px) {
    reference.view = {upright(0.0), {}};
    for (const BoardPoint at : {BoardPoint{-260, 70}, {-20, 120}, {250, 60}, {-240, -90}, {30, -110}, {260, -80}}) {
      Marker marker;
      marker.circle = Circle{at, 16.0};
      const IdealPoint rest = bent(upright(0.0)(at), distortion), now = bent(upright(pan_px)(at), distortion);
      MarkerObservation seen;
      seen.circle.emplace().centre = {rest.x, rest.y};
      reference.seen.markers.push_back(seen);
      points.push_back({reference.site.markers.size(), at, now, 0.03});
      reference.site.markers.push_back(marker);
    }
  }
};

TEST(SlippedCircle, IsRemovedIfItAloneExplainsTheDeviation) {
  Wall wall(0.0, 100.0);
  wall.points[2].ideal.y += 6.0;
  EXPECT_EQ(remove_slipped(wall.reference, wall.points), 2U);
  EXPECT_EQ(wall.points.size(), 5U);
}

// A lens of -2 % and a pan of 200 px leave residuals beyond half a pixel. Every circle has its share of them, so
// without any one of them most of the residual remains.
TEST(SlippedCircle, ALensIsNoSlip) {
  for (const double pan_px : {100.0, 200.0, 300.0}) {
    Wall wall(-0.02, pan_px);
    EXPECT_EQ(remove_slipped(wall.reference, wall.points), std::nullopt) << pan_px;
    EXPECT_EQ(wall.points.size(), 6U);
  }
}

}  // namespace
}  // namespace moiregauge::internal
