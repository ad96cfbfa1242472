// SPDX-License-Identifier: Apache-2.0
// Tests the phase and the displacement of every pattern against the simulator's own geometry, without noise. Gratings
// are dark on light and light on dark, at short and long pitches, face on and at 40 deg, upright and oblique.
#include <array>
#include <cmath>
#include <ostream>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "moiregauge/observation/raster/patch.h"
#include "moiregauge/simulator/simulator.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using simulator::Scenario;

// A seventh of the required 0.002 px. The simulator's images are right to 5e-5 of the contrast in the worst pixel. The
// spline leaves 2e-4 rad of phase between the pixels of a fringe of 5 px, which is 0.00016 px.
constexpr double kPatternGate_px = 0.0003;

constexpr double kMillimetresPerPixel = 1200.0 / 3478.26;  // for a board seen face on
// Three pitches of 29 px: the smallest grating in which a window of 2 T leaves a region.
constexpr double kPrint_px = 87.0;

// Angle of the lattice to the pixels: roll of the camera and rotation of the grating on the board.
struct Lie {
  double roll_deg, angle_deg;
};
constexpr std::array kLies{Lie{0.0, 0.0}, Lie{17.0, 0.0}, Lie{0.0, 30.0}, Lie{45.0, 0.0}, Lie{10.0, 35.0}};

struct Sight {
  Pattern pattern;
  double pitch_px, tilt_deg;
  bool about_y, inverted;
  Lie lie;
};

std::ostream& operator<<(std::ostream& out, const Sight& v) {
  return out << word_for(v.pattern) << (v.inverted ? ", inverted" : "") << ", P " << v.pitch_px << " px, " << v.tilt_deg
             << " deg about " << (v.about_y ? "y" : "x") << ", roll " << v.lie.roll_deg << ", turned "
             << v.lie.angle_deg;
}

// Returns a scene with one grating, displaced on the board by `moved`.
Scenario scene(const Sight& v, Extent<frame::Board> moved) {
  Scenario s;
  s.camera.width = s.camera.height = static_cast<int>(1.45 * kPrint_px) + 24;
  s.camera.cx = 0.5 * s.camera.width - 0.19;  // nothing is at whole pixels
  s.camera.cy = 0.5 * s.camera.height - 0.67;
  s.mount.board_x_deg = v.about_y ? 0.0 : v.tilt_deg;
  s.mount.board_y_deg = v.about_y ? v.tilt_deg : 0.0;
  s.mount.board_z_deg = v.lie.roll_deg;
  simulator::SceneMarker marker;
  marker.print.role = Role::kTarget;
  marker.print.grating = Grating{.centre = {0.0, 0.0},
                                 .width_mm = kPrint_px * kMillimetresPerPixel,
                                 .height_mm = kPrint_px * kMillimetresPerPixel,
                                 .pitch_mm = v.pitch_px * kMillimetresPerPixel,
                                 .angle_rad = radians_from_degrees(v.lie.angle_deg),
                                 .pattern = v.pattern};
  marker.inverted = v.inverted;
  marker.place.x_mm = moved.x;
  marker.place.y_mm = moved.y;
  s.markers.push_back(marker);
  return s;
}

Image<std::uint16_t> picture_of(const Scenario& scenario) {
  const Image<double> light = render_ideal(scenario, 0, {1, simulator::Area::kMarkersOnly});
  Image<std::uint16_t> fine(light.width(), light.height());
  for (int y = 0; y < light.height(); ++y) {
    for (int x = 0; x < light.width(); ++x)
      fine.at(x, y) = static_cast<std::uint16_t>(std::lround(256.0 * light.at(x, y)));
  }
  return fine;
}

View view_of_target(const Scenario& scenario) {
  std::vector<BoardPoint> board;
  std::vector<IdealPoint> ideal;
  for (const double x : {-15.0, 0.0, 15.0}) {
    for (const double y : {-15.0, 0.0, 15.0}) {
      board.push_back({x, y});
      const ImagePoint p = project(scenario, 0, board.back());
      ideal.push_back({p.x, p.y});
    }
  }
  return {*fit_homography<frame::Ideal, frame::Board>(board, ideal), Camera{}};
}

struct Worst {
  double phase_px = 0.0, displacement_px = 0.0;
};

// Returns the largest errors of a grating in its reference position, and in positions distributed over a pitch along
// both axes. The window moves to the grating's last position, some tenths of a pixel away.
Worst worst_of(const Sight& v) {
  Worst worst;
  const Scenario at_rest = scene(v, {});
  const Grating& grating = *at_rest.markers[0].print.grating;
  const View view = view_of_target(at_rest);
  const double px = view.mm_per_px(grating.centre);
  const auto plan = plan_raster(grating, view.finest_mm_per_px(grating.centre), {});
  EXPECT_TRUE(plan) << v;
  if (!plan) return worst;
  const PatchReading rest = read_patch(picture_of(at_rest).view(), 16, view, *plan, {});
  EXPECT_TRUE(rest.valid) << v;
  // The centre of a grating is the middle of a dark part. That of a cosine is a crest.
  const double there = (v.pattern == Pattern::kCosine) == v.inverted ? kPi : 0.0;
  const auto in_px = [&](double rad) { return std::abs(wrapped(rad)) / kTwoPi * plan->pitch_mm / px; };
  for (const double phase : rest.phase_rad)
    worst.phase_px = std::max(worst.phase_px, in_px(phase - there));  // NaN is ignored
  for (const auto& [along, across] : {std::array{-0.36, 0.11}, std::array{0.07, -0.43}, std::array{0.29, 0.34}}) {
    const Extent<frame::Board> moved{along * grating.pitch_mm, across * grating.pitch_mm};
    const Extent<frame::Board> window = moved + Extent<frame::Board>{0.3 * px, -0.2 * px};
    const PatchReading now = read_patch(picture_of(scene(v, moved)).view(), 16, view, *plan, window);
    EXPECT_TRUE(now.valid) << v;
    // By raster axis, which also tests oblique lines: position of the grating relative to the window.
    const auto expected = raster_from_board(*plan, moved + (-1.0) * window);
    for (std::size_t a = 0; a < 2; ++a) {
      const double seen = -plan->pitch_mm / kTwoPi * wrapped(now.phase_rad[a] - rest.phase_rad[a]);
      worst.displacement_px = std::max(worst.displacement_px, std::abs(seen - expected[a]) / px);
    }
    if (!plan->reads_x || !plan->reads_y) continue;
    const auto d = displacement_at(*plan, rest, now, window) + (-1.0) * moved;
    worst.displacement_px = std::max(worst.displacement_px, std::hypot(d.x, d.y) / px);
  }
  return worst;
}

class EveryPattern : public testing::TestWithParam<std::tuple<Pattern, double, double>> {};

TEST_P(EveryPattern, IsReadWhereItIs) {
  const auto [pattern, pitch_px, tilt_deg] = GetParam();
  Worst worst;
  bool inverted = false;
  for (const Lie& lie : kLies) {
    for (const bool about_y : {false, true}) {
      if (about_y && tilt_deg == 0.0) continue;
      inverted = !inverted;
      const Sight v{pattern, pitch_px, tilt_deg, about_y, inverted, lie};
      const Worst here = worst_of(v);
      EXPECT_LE(here.phase_px, kPatternGate_px) << v;
      EXPECT_LE(here.displacement_px, kPatternGate_px) << v;
      worst.phase_px = std::max(worst.phase_px, here.phase_px);
      worst.displacement_px = std::max(worst.displacement_px, here.displacement_px);
    }
    inverted = !inverted;  // at 20 and 40 deg each axis has both polarities
  }
  RecordProperty("phase_px", std::to_string(worst.phase_px));
  RecordProperty("displacement_px", std::to_string(worst.displacement_px));
}

std::string name_of(const testing::TestParamInfo<EveryPattern::ParamType>& info) {
  std::string name = word_for(std::get<0>(info.param));
  std::erase(name, '-');
  return name + "P" + std::to_string(static_cast<int>(std::get<1>(info.param))) + "At" +
         std::to_string(static_cast<int>(std::get<2>(info.param))) + "Degrees";
}

INSTANTIATE_TEST_SUITE_P(Physics, EveryPattern,
                         testing::Combine(testing::Values(Pattern::kGrid, Pattern::kSquares, Pattern::kDots,
                                                          Pattern::kLinesX, Pattern::kLinesY, Pattern::kCheckerboard,
                                                          Pattern::kCosine),
                                          testing::Values(7.0, 12.0, 29.0), testing::Values(0.0, 20.0, 40.0)),
                         name_of);

// Lines rotated by 5 deg show 0.087 of a movement along y. That must not become a movement along x.
TEST(EveryPatternOfLines, ObliqueToBothAxesMeasureNeither) {
  const auto read_at = [](double turned_deg) {
    const Sight v{Pattern::kLinesX, 12.0, 0.0, false, false, {0.0, turned_deg}};
    const Scenario at_rest = scene(v, {}), moved = scene(v, {0.0, 1.0});
    const View view = view_of_target(at_rest);
    const Grating& grating = *at_rest.markers[0].print.grating;
    const auto plan = plan_raster(grating, view.finest_mm_per_px(grating.centre), {});
    const PatchReading then = read_patch(picture_of(at_rest).view(), 16, view, *plan, {});
    const PatchReading now = read_patch(picture_of(moved).view(), 16, view, *plan, {});
    return displacement_between(*plan, then, now);
  };
  const auto upright = read_at(0.0), oblique = read_at(5.0);
  EXPECT_NEAR(upright.x, 0.0, kPatternGate_px * kMillimetresPerPixel);
  EXPECT_TRUE(std::isnan(upright.y));
  EXPECT_TRUE(std::isnan(oblique.x) && std::isnan(oblique.y));
}

// Lines do not show movement along themselves. The window is fixed, and an end of the grating enters it.
TEST(EveryPatternOfLines, AreReadWhileAPartIsInTheWindow) {
  for (const double along_px : {-40.0, -20.0, 30.0}) {
    const Sight v{Pattern::kLinesX, 7.0, 0.0, false, false, {}};
    const double across_px = 1.3;
    const Scenario at_rest = scene(v, {});
    const Scenario moved = scene(v, {across_px * kMillimetresPerPixel, along_px * kMillimetresPerPixel});
    const View view = view_of_target(at_rest);
    const Grating& grating = *at_rest.markers[0].print.grating;
    const auto plan = plan_raster(grating, view.finest_mm_per_px(grating.centre), {});
    const PatchReading then = read_patch(picture_of(at_rest).view(), 16, view, *plan, {});
    const PatchReading now = read_patch(picture_of(moved).view(), 16, view, *plan, {});
    ASSERT_TRUE(now.valid) << along_px;
    EXPECT_NEAR(displacement_between(*plan, then, now).x / kMillimetresPerPixel, across_px, 0.002) << along_px;
    EXPECT_GT(now.u_phase_rad[0], 1.1 * then.u_phase_rad[0]) << along_px;
  }
}

}  // namespace
}  // namespace moiregauge::internal
