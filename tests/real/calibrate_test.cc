// SPDX-License-Identifier: Apache-2.0
// A camera solved from a set's own views, and the nulls of the set with its lens taken out (the table of
// tests/real/data/SOURCES.md).
#include <cmath>

#include <gtest/gtest.h>

#include "real/real_calibration.h"

namespace moiregauge {
namespace {

const std::string kData = std::string(MOIREGAUGE_SOURCE_DIR) + "/tests/real/data";

struct Solved {
  std::vector<test::LatticeView> views;
  BoardCalibration camera;
};

Solved solved(const std::string& name) {
  Solved s{test::lattice_views(kData, test::photo_set(name)), {}};
  s.camera = test::calibrated(s.views);
  return s;
}

TEST(CalibrateHandheldChess, TakesTheBarrelOutOfTheFourCornerNull) {
  const Solved s = solved("handheld-chess");
  const double raw = test::median_null(s.views, {}), null = test::median_null(s.views, s.camera.camera);
  ::testing::Test::RecordProperty("null_px", std::to_string(null));
  EXPECT_GE(raw, 1.4);
  EXPECT_LE(null, 0.33);
  EXPECT_LE(s.camera.rms_px, 0.2);
  for (const CalibratedView& view : s.camera.views) EXPECT_EQ(view.left_out, "");
  // The lens all the world has solved from these pictures: k1 of about -0.29.
  EXPECT_NEAR(s.camera.camera.k1, -0.29, 0.01);
}

TEST(CalibrateHandheldChess, HalvesOfTheViewsAgreeWithinWhatEachStates) {
  const auto views = test::lattice_views(kData, test::photo_set("handheld-chess"));
  const auto half = [&](std::size_t from) {
    std::vector<test::LatticeView> some;
    for (std::size_t i = from; i < views.size(); i += 2) some.push_back(views[i]);
    return test::calibrated(some);
  };
  const BoardCalibration a = half(0), b = half(1);
  const auto check = [&](const char* name, double one, double other, std::size_t k) {
    EXPECT_LE(std::abs(one - other), 3.0 * std::hypot(a.u[k], b.u[k])) << name;
  };
  check("f", a.camera.fx, b.camera.fx, 0);
  check("cx", a.camera.cx, b.camera.cx, 1);
  check("cy", a.camera.cy, b.camera.cy, 2);
  check("k1", a.camera.k1, b.camera.k1, 3);
  check("k2", a.camera.k2, b.camera.k2, 4);
}

// The print's own errors are twenty times the points' noise: taken for a lens they would bend what is straight.
TEST(CalibrateStereoDots, ALongLensChangesNothing) {
  const Solved s = solved("stereo-dots");
  EXPECT_EQ(s.camera.matched, 14) << "views recognised by their print";
  EXPECT_LE(s.camera.point_px, 0.05);
  EXPECT_NEAR(test::median_null(s.views, s.camera.camera), test::median_null(s.views, {}), 0.01);
  EXPECT_NEAR(test::worst_null(s.views, s.camera.camera), test::worst_null(s.views, {}), 0.01);
}

TEST(CalibrateBoardDots, TheLatticesPhaseIsFlatOnceTheLensIsOut) {
  const Solved s = solved("board-dots");
  const auto phases = test::phase_places(s.views[0], s.views[1], LatticeKind::kDots);
  const double raw = test::null_between(phases.first, phases.second).rms_px;
  const double null = test::null_between(test::without_lens(phases.first, s.camera.camera),
                                         test::without_lens(phases.second, s.camera.camera))
                          .rms_px;
  RecordProperty("null_px", std::to_string(null));
  EXPECT_GE(raw, 0.1);
  EXPECT_LE(null, 0.07);
}

TEST(CalibrateBoardChecker, TheCornersAndThePhaseAreFlatOnceTheLensIsOut) {
  const Solved s = solved("board-checker");
  EXPECT_LE(test::median_null(s.views, s.camera.camera), 0.12);
  const auto phases = test::phase_places(s.views[0], s.views[1], LatticeKind::kCheckerCorners);
  const double null = test::null_between(test::without_lens(phases.first, s.camera.camera),
                                         test::without_lens(phases.second, s.camera.camera))
                          .rms_px;
  RecordProperty("null_px", std::to_string(null));
  EXPECT_LE(null, 0.07);
}

}  // namespace
}  // namespace moiregauge
