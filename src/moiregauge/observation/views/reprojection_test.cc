// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/views/reprojection.h"

#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/observation/frame/observe.h"
#include "moiregauge/simulator/scenario/built_in.h"
#include "moiregauge/simulator/simulator.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr double kK1 = -0.37;  // -1 % at the small rig's corner
constexpr long kLater = 60;    // the camera has rotated by 0.4 deg

// Small rig without noise, so that only errors of the method remain.
const simulator::Scenario& scenario() {
  static const auto made = [] {
    auto rig = simulator::built_in("small-1xyz").value();
    rig.camera.k1 = kK1;
    rig.sensor.noise_sigma = 0.0;
    return rig;
  }();
  return made;
}

const Image<std::uint8_t>& picture(long frame) {
  static const auto first = render8(scenario(), 0, {0, simulator::Area::kMarkersOnly});
  static const auto later = render8(scenario(), kLater, {0, simulator::Area::kMarkersOnly});
  return frame == 0 ? first : later;
}

const Site& true_site() {
  static const Site site = simulator::site_of(scenario());
  return site;
}

Camera true_lens() {
  Camera camera;
  camera.width = picture(0).width();
  camera.height = picture(0).height();
  camera.fx = camera.fy = 3478.26;
  camera.cx = 511.5;
  camera.cy = 255.5;
  camera.k1 = kK1;
  return camera;
}

// One reference is wrong as a whole, one grating relative to its circle, the target, and one angle.
Site wrong_site() {
  Site site = true_site();
  Marker& first = site.markers[0];
  first.circle->centre = first.circle->centre + Extent<frame::Board>{1.0, -0.6};
  first.grating->centre = first.grating->centre + Extent<frame::Board>{1.4, -0.3};
  site.markers.back().grating->centre = site.markers.back().grating->centre + Extent<frame::Board>{0.8, -0.5};
  site.markers[2].grating->angle_rad += radians_from_degrees(0.2);
  return site;
}

struct Film {
  Reference reference;
  Observations observations;
};

Film seen_with(const Site& site, const Camera& lens) {
  Film run{make_reference({picture(0).view(), 8}, site, lens, {}).value(), {}};
  run.observations.push_back(observe_two_stage({picture(kLater).view(), 8}, run.reference, {}));
  return run;
}

Extent<frame::Board> displacement(const Reference& reference, const Observation& seen) {
  const std::size_t target = reference.site.markers.size() - 1;
  return displacement_at(reference.plans[target], reference.seen.markers[target].patch, seen.markers[target].patch,
                         seen.markers[target].window_shift);
}

// Allows a fiftieth of the effect of the change. The rest is of second order, and from the pixels at the windows'
// edges.
void expect_as_if_measured_with(const Film& now, const Film& then) {
  const auto again = reproject_observations(then.reference, then.observations, now.reference.site, now.reference.lens);
  ASSERT_TRUE(again) << again.error();
  const auto wanted = displacement(now.reference, now.observations[0]);
  const auto before = displacement(then.reference, then.observations[0]);
  const auto got = displacement(again->reference, again->observations[0]);
  EXPECT_GT(length(before - wanted), 0.002);  // mm: the change has an effect
  EXPECT_LT(length(got - wanted), 0.02 * length(before - wanted) + 5e-5);
  // The second homography maps the board to the same pixels to 0.001 px.
  const BoardPoint corner{100.0, -40.0};
  EXPECT_LT(length(again->observations[0].stage2(corner) - now.observations[0].stage2(corner)), 0.001);
}

TEST(Reprojected, AnotherLensGivesTheResultOfMeasuringWithIt) {
  expect_as_if_measured_with(seen_with(true_site(), true_lens()), seen_with(true_site(), {}));
}

TEST(Reprojected, AnotherSiteGivesTheResultOfMeasuringWithIt) {
  expect_as_if_measured_with(seen_with(true_site(), {}), seen_with(wrong_site(), {}));
}

TEST(Reprojected, WithTheSameSiteAndLensNothingChanges) {
  const Film run = seen_with(true_site(), true_lens());
  const auto again = reproject_observations(run.reference, run.observations, true_site(), true_lens());
  ASSERT_TRUE(again) << again.error();
  // Only the rounding of packed phases remains.
  EXPECT_LT(
      length(displacement(again->reference, again->observations[0]) - displacement(run.reference, run.observations[0])),
      1e-6);
}

TEST(Reprojected, PointsReferToTheNewPositionOfTheGrating) {
  Film then = seen_with(wrong_site(), {}), now = seen_with(true_site(), {});
  learn_prints({picture(0).view(), 8}, then.reference);
  learn_prints({picture(0).view(), 8}, now.reference);
  const auto again = reproject_observations(then.reference, {}, true_site(), {});
  ASSERT_TRUE(again) << again.error();
  const std::size_t target = true_site().markers.size() - 1;
  const auto middle = [&](const Reference& reference) {
    const PatchFit& fit = *reference.seen.markers[target].points;
    const auto map = fit_homography<frame::Image, frame::Print>(fit.print, fit.image);
    return (*map)(PrintPoint{0, 0});
  };
  EXPECT_GT(length(middle(then.reference) - middle(now.reference)), 2.0);  // px: 0.8 and 0.5 mm
  // A template's zero stays at its first map, except for the movement in the rounds. These start 2 px away here. No
  // measurement depends on it.
  EXPECT_LT(length(middle(again->reference) - middle(now.reference)), 0.3);
}

TEST(Reprojected, NamesTheMarkerThatDoesNotFit) {
  const Film run = seen_with(true_site(), {});
  const auto problem = [&](auto change) {
    Site site = true_site();
    change(site);
    const auto again = reproject_observations(run.reference, run.observations, site, {});
    return again ? std::string() : again.error();
  };
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(problem([](Site& s) { s.markers.pop_back(); }), "'mid' is missing"));
  EXPECT_TRUE(has(problem([](Site& s) { s.markers[0].name = "XX"; }), "'XX' was not measured"));
  EXPECT_TRUE(has(problem([](Site& s) { s.markers[1].grating->pitch_mm = 10.3; }), "pitch_mm = 10.3"));
  EXPECT_TRUE(has(problem([](Site& s) { s.markers[1].grating->angle_rad = 0.1; }), "angle_deg"));
  EXPECT_TRUE(has(problem([](Site& s) { s.markers[1].circle.reset(); }), "circle and grating"));
  EXPECT_TRUE(has(problem([](Site& s) { s.markers.back().grating->centre.x = 21.0; }), "was measured 21 mm"));
  EXPECT_TRUE(has(problem([](Site& s) { std::swap(s.markers[0].circle, s.markers[1].circle); }), "was measured"));
  EXPECT_EQ(problem([](Site& s) { std::swap(s.markers[0], s.markers[1]); }), "");
  EXPECT_EQ(problem([](Site& s) { s.known_to.position_mm = 7.0; }), "");
}

}  // namespace
}  // namespace moiregauge::internal
