// SPDX-License-Identifier: Apache-2.0
// Faults in front of the camera, of its clock, and of the site file.
#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "moiregauge/simulator/faults_for_tests.h"
#include "moiregauge/simulator/rendering/projection.h"
#include "moiregauge/simulator/scenario/settings.h"

namespace moiregauge::internal::simulator {
namespace {

double rendered_at(const Scenario& scenario, long frame, BoardPoint point) {
  const ImagePoint p = project(scenario, frame, scenario.markers[0], point);
  return render_ideal(scenario, frame).at(static_cast<int>(std::lround(p.x)), static_cast<int>(std::lround(p.y)));
}

Scenario with_cover() {
  Scenario scenario = lines(Pattern::kLinesX);
  scenario.markers[0].cover = {.frames = {{0, 100}}, .share = 0.5, .height_share = 0.5, .grey = 77.0};
  return scenario;
}

TEST(Cover, OfOneCornerDoesNotAffectTheOtherThree) {
  const Scenario scenario = with_cover();
  EXPECT_NEAR(rendered_at(scenario, 0, {-9.0, -6.0}), 77.0, 1e-6);
  for (const BoardPoint open : {BoardPoint{-9.0, 6.0}, BoardPoint{9.0, 6.0}, BoardPoint{9.0, -6.0}})
    EXPECT_EQ(rendered_at(scenario, 0, open), rendered_at(lines(Pattern::kLinesX), 0, open));
}

TEST(Cover, MovesWithoutAChangeOfTheTruth) {
  Scenario scenario = with_cover();
  scenario.markers[0].cover.x_mm.knots = {{0.0, 0.0}, {1.0, 18.0}};
  EXPECT_GT(std::abs(rendered_at(scenario, 0, {9.0, -6.0}) - 77.0), 10.0);
  EXPECT_NEAR(rendered_at(scenario, 10, {9.0, -6.0}), 77.0, 1e-6);
  EXPECT_EQ(truth(scenario, 10, scenario.markers[0]).dx_mm, 0.0);
}

TEST(Cover, MayBeAShadowOrRough) {
  Scenario scenario = with_cover();
  scenario.markers[0].cover.grey = 0.0;
  scenario.markers[0].cover.opacity = 0.4;
  const BoardPoint there{-9.0, -6.0};
  EXPECT_NEAR(rendered_at(scenario, 0, there), 0.6 * rendered_at(lines(Pattern::kLinesX), 0, there), 1e-6);
  scenario = with_cover();
  scenario.markers[0].cover.texture = 20.0;
  EXPECT_GT(std::abs(rendered_at(scenario, 0, there) - rendered_at(scenario, 0, {-7.0, -7.0})), 1.0);
}

TEST(Fold, ShiftsTheHalfRightOfTheCrease) {
  Scenario scenario = lines(Pattern::kLinesX), flat = scenario;
  const double pixel = 1.0 / px_per_mm(scenario);
  scenario.markers[0].fold_mm.offset = 2.0 * pixel;
  const auto folded = render_ideal(scenario, 0), before = render_ideal(flat, 0);
  const int y = 60, middle = static_cast<int>(std::lround(project(flat, 0, {0.0, 0.0}).x));
  for (int x = middle - 30; x < middle - 5; ++x) EXPECT_EQ(folded.at(x, y), before.at(x, y));
  for (int x = middle + 8; x < middle + 30; ++x) EXPECT_NEAR(folded.at(x, y), before.at(x - 2, y), 1e-6);
}

TEST(Fold, MayChangeOverTime) {
  Scenario scenario = lines(Pattern::kLinesX);
  scenario.markers[0].fold_mm.knots = {{0.5, 0.0}, {0.6, 0.5}};
  EXPECT_EQ(rendered_at(scenario, 4, {7.3, 0.0}), rendered_at(lines(Pattern::kLinesX), 4, {7.3, 0.0}));
  EXPECT_NE(rendered_at(scenario, 9, {7.3, 0.0}), rendered_at(lines(Pattern::kLinesX), 9, {7.3, 0.0}));
}

TEST(Stretch, IsAlongOneAxisOnly) {
  Scenario scenario = lines(Pattern::kGrid);
  scenario.markers[0].place.stretch_x = 0.002;
  const SceneMarker& marker = scenario.markers[0];
  const ImagePoint middle = project(scenario, 0, marker, {0.0, 0.0});
  const double along_x = project(scenario, 0, marker, {10.0, 0.0}).x - middle.x;
  const double along_y = middle.y - project(scenario, 0, marker, {0.0, 10.0}).y;
  EXPECT_NEAR(along_x / along_y, 1.002, 1e-12);
}

TEST(Haze, IsIndependentForEachMarkerAndNoDisplacement) {
  Scenario scenario = *built_in("small-still");
  scenario.haze = {.rms_mm = 0.05, .step_s = 0.1};
  const Scenario still = *built_in("small-still");
  const SceneMarker &a = scenario.markers[0], &b = scenario.markers[1];
  double sum = 0.0, common = 0.0;
  constexpr int kFrames = 400;
  for (long frame = 0; frame < kFrames; ++frame) {
    const auto wander = [&](const SceneMarker& marker) {
      const BoardPoint c = centre_of(marker.print);
      return (project(scenario, frame, marker, c).x - project(still, frame, marker, c).x) / px_per_mm(scenario);
    };
    sum += wander(a) * wander(a) / kFrames;
    common += wander(a) * wander(b) / kFrames;
  }
  EXPECT_NEAR(std::sqrt(sum), 0.05, 4.0 * 0.05 / std::sqrt(2.0 * kFrames));
  EXPECT_LT(std::abs(common), 4.0 * 0.05 * 0.05 / std::sqrt(kFrames));
  EXPECT_EQ(truth(scenario, 3, a).dx_mm, 0.0);
}

TEST(Interlaced, OddRowsAreHalfAFrameLater) {
  Scenario scenario = lines(Pattern::kLinesX);
  scenario.sensor.interlaced = true;
  const double step = 4.0 / px_per_mm(scenario);  // 4 px in half a frame
  scenario.sensor.exposure_s = 0.0;
  scenario.markers[0].dx.knots = {{0.0, 0.0}, {0.05, step}};
  const auto picture = render_ideal(scenario, 0);
  for (int x = 40; x < 110; ++x) EXPECT_NEAR(picture.at(x + 4, 61), picture.at(x, 60), 1e-6);
}

TEST(Timing, JitterMovesExposureStampAndTruthTogether) {
  Scenario scenario = lines(Pattern::kLinesX);
  scenario.timing.jitter_s = 0.02;
  scenario.markers[0].dy.knots = {{-1.0, -1.0}, {100.0, 100.0}};  // 1 mm/s
  double most = 0.0;
  for (long frame = 0; frame < 50; ++frame) {
    const double late = time_of(scenario, frame) - 0.1 * static_cast<double>(frame);
    most = std::max(most, std::abs(late));
    EXPECT_EQ(stamp_of(scenario, frame), time_of(scenario, frame));
    EXPECT_NEAR(truth(scenario, frame, scenario.markers[0]).dy_mm, time_of(scenario, frame) - time_of(scenario, 0),
                1e-12);
  }
  EXPECT_LE(most, 0.02);
  EXPECT_GT(most, 0.015) << "of 50 even draws";
  scenario.timing.nominal_stamps = true;
  EXPECT_EQ(stamp_of(scenario, 7), 0.7);
}

TEST(Timing, StampsMayBeWrongWhileShotsAreOnTime) {
  Scenario scenario = lines(Pattern::kLinesX);
  scenario.timing.stamp_jitter_s = 0.03;
  std::set<double> errors;
  for (long frame = 0; frame < 20; ++frame) {
    EXPECT_EQ(time_of(scenario, frame), static_cast<double>(frame) / 10.0);
    errors.insert(stamp_of(scenario, frame) - time_of(scenario, frame));
  }
  EXPECT_EQ(errors.size(), 20U);
  EXPECT_LE(*errors.rbegin(), 0.03);
}

TEST(Timing, DroppedShotsAreMissing) {
  Scenario scenario = lines(Pattern::kLinesX);
  scenario.timing.dropped = {{2, 4}, {6, 7}};
  const long expected[] = {0, 1, 4, 5, 7, 8};
  for (long frame = 0; frame < 6; ++frame) EXPECT_EQ(shot_of(scenario, frame), expected[frame]);
  EXPECT_EQ(stamp_of(scenario, 2), 0.4);
  scenario.timing.nominal_stamps = true;
  EXPECT_EQ(stamp_of(scenario, 2), 0.2);
  EXPECT_EQ(time_of(scenario, 2), 0.4);
}

TEST(Timing, RepeatedFramesAreTheSameBytesAtALaterTime) {
  Scenario scenario = lines(Pattern::kLinesX);
  scenario.markers[0].dy.knots = {{0.0, 0.0}, {10.0, 10.0}};
  scenario.timing.repeated = {{3, 5}};
  const auto before = render8(scenario, 2), again = render8(scenario, 4), after = render8(scenario, 5);
  EXPECT_TRUE(std::ranges::equal(before.row(60), again.row(60)));
  EXPECT_FALSE(std::ranges::equal(before.row(60), after.row(60)));
  EXPECT_EQ(truth(scenario, 4, scenario.markers[0]).dy_mm, truth(scenario, 2, scenario.markers[0]).dy_mm);
  EXPECT_EQ(stamp_of(scenario, 4), 0.4);
  EXPECT_EQ(shot_of(scenario, 5), 5);
}

TEST(SiteErrors, MayNameTwoMarkersWronglyOrBeMirrored) {
  Scenario scenario = *built_in("small-still");
  scenario.site_errors.exchanged = {{"NW", "mid"}};
  Site site = site_of(scenario);
  EXPECT_EQ(site.markers[0].name, "NW");
  EXPECT_EQ(site.markers[0].grating->centre.x, 0.0);
  EXPECT_EQ(site.markers[0].role, Role::kReference);
  EXPECT_EQ(site.markers[4].grating->centre.x, -100.0);
  scenario.site_errors = {.mirrored = true, .exchanged = {}};
  site = site_of(scenario);
  EXPECT_EQ(site.markers[0].circle->centre.x, 128.0);
  EXPECT_EQ(site.markers[0].circle->centre.y, 40.0);
}

TEST(Settings, IncludeEveryFault) {
  Scenario scenario = *built_in("small-still");
  const auto set = [&](const char* name, const char* value) {
    for (const Setting& setting : settings_of(scenario)) {
      if (setting.name == name) return setting.set(value);
    }
    return false;
  };
  EXPECT_TRUE(set("light.slope_x", "0.2"));
  EXPECT_TRUE(set("light.flicker.knots", "[[0, 0], [1, 0.4]]"));
  EXPECT_TRUE(set("sensor.defocus_disc_px", "4"));
  EXPECT_TRUE(set("lens.zoom.amplitude", "0.003"));
  EXPECT_TRUE(set("timing.dropped", "3 5"));
  EXPECT_TRUE(set("print.scale", "0.002"));
  EXPECT_TRUE(set("site.exchanged", "NW mid"));
  EXPECT_FALSE(set("site.exchanged", "NW missing"));
  EXPECT_TRUE(set("marker.NE.cover.x_mm.knots", "0 -30 1 30"));
  EXPECT_TRUE(set("marker.mid.glare.grey", "150"));
  EXPECT_TRUE(set("marker.mid.fold_mm", "0.3"));
  EXPECT_EQ(scenario.light.slope_x.at(0.0), 0.2);
  EXPECT_EQ(scenario.markers[2].place.print_scale, 0.002);
  EXPECT_FALSE(problem_with(scenario).has_value());
  EXPECT_TRUE(set("sensor.defocus_disc_px.amplitude", "61"));
  EXPECT_TRUE(problem_with(scenario).has_value()) << "4 + 61 px of blur take minutes to render";
  EXPECT_TRUE(set("sensor.defocus_disc_px.amplitude", "60"));
  EXPECT_FALSE(problem_with(scenario).has_value());
  scenario.timing.jitter_s = 0.06;
  EXPECT_TRUE(problem_with(scenario).has_value()) << "time stamps might fall";
}

}  // namespace
}  // namespace moiregauge::internal::simulator
