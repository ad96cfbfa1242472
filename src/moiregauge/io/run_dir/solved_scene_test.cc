// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/run_dir/solved_scene.h"

#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/calibration/scene/frame_fit.h"
#include "moiregauge/calibration/scene/patch_residual.h"
#include "moiregauge/io/config/site_file.h"

namespace moiregauge::internal {
namespace {

// Two references, and a target without a stated height.
Site site() {
  Site s;
  for (const auto& [name, x] : {std::pair{"W", -100.0}, std::pair{"E", 100.0}})
    s.markers.push_back({name,
                         Role::kReference,
                         Circle{{1.3 * x, 5.0}, 20.0},
                         Grating{{x, 0.0}, 40.0, 40.0, 10.0, 0.1, Pattern::kGrid},
                         {}});
  s.markers.push_back({"T", Role::kTarget, {}, Grating{{0.0, 3.0}, 40.0, 40.0, 10.0, 0.0, Pattern::kGrid}, {}});
  return s;
}

Scene scene() {
  Scene s;
  s.solved = true;
  s.markers = {{{0.3, -0.2, 0.004, 0.0003, 1.5}}, {{-0.1, 0.5, -0.002, -0.0002, -0.5}}, {{0, 0, 0.001, 0.0001, -30.0}}};
  s.covariance = Eigen::MatrixXd::Zero(scene_parameters(3), scene_parameters(3));
  return s;
}

void know(Scene& s, std::size_t marker, int parameter, double u) {
  s.covariance(shape_row(marker, parameter), shape_row(marker, parameter)) = u * u;
}

TEST(SolvedScene, ProjectionBySolvedShapesEqualsProjectionByTheSolvedSite) {
  Scene s = scene();
  for (const std::size_t i : {0, 1, 2}) know(s, i, MarkerShape::kHeight, 0.1);
  const Site before = site(), after = solved_site(before, s);
  const double camera[]{1000.0, 500.0, 400.0, -0.1, 0.02, 0.0, 0.0, 0.0, s.stretch},
      pose[]{0.1, -0.2, 0.3, 5.0, 6.0, 1200.0};
  // Nine points that fit no board, so that residuals are far from zero. They must be equal.
  PatchFit fit;
  for (std::size_t n = 0; n < kPatchPoints; ++n) {
    const double x = static_cast<double>(n % 3) - 1.0, y = static_cast<double>(n / 3) - 1.0;
    fit.print[n] = {1.5 * x, 1.5 * y};
    fit.image[n] = {500.0 + 20.0 * x, 300.0 - 21.0 * y};
  }
  fit.information.setIdentity();
  for (std::size_t i = 0; i < 3; ++i) {
    double then[PatchResidual::kSize], now[PatchResidual::kSize];
    MarkerShape rest;
    rest.value[MarkerShape::kHeight] = after.markers[i].z_mm.value();
    PatchResidual(fit, before.markers[i])(camera, s.markers[i].value.data(), pose, then);
    PatchResidual(fit, after.markers[i])(camera, rest.value.data(), pose, now);
    for (int k = 0; k < PatchResidual::kSize; ++k) EXPECT_NEAR(then[k], now[k], 1e-9) << before.markers[i].name;
  }
}

TEST(SolvedScene, ACircleMovesWithItsGrating) {
  const Scene s = scene();
  const Site before = site(), after = solved_site(before, s);
  for (const std::size_t i : {0, 1}) {
    const auto arm = [](const Marker& m) { return m.circle->centre - m.grating->centre; };
    const auto then = arm(before.markers[i]), now = arm(after.markers[i]);
    const auto& shape = s.markers[i].value;
    EXPECT_NEAR(length(now), length(then) * (1.0 + shape[MarkerShape::kScale]), 1e-12);
    EXPECT_NEAR(std::atan2(now.y, now.x) - std::atan2(then.y, then.x), shape[MarkerShape::kRotation], 1e-12);
  }
}

TEST(SolvedScene, KnownToCoversCommonErrors) {
  Scene s = scene();
  // A common error of 0.0002 in all scales: three independent errors must cover it.
  for (const std::size_t i : {0, 1, 2}) {
    for (const std::size_t j : {0, 1, 2})
      s.covariance(shape_row(i, MarkerShape::kScale), shape_row(j, MarkerShape::kScale)) = 0.0002 * 0.0002;
  }
  // Independent positions: the largest u counts.
  know(s, 0, MarkerShape::kX, 0.1);
  know(s, 0, MarkerShape::kY, 0.2);
  know(s, 1, MarkerShape::kX, 0.3);
  const Site solved = solved_site(site(), s);
  EXPECT_NEAR(solved.known_to.print_scale, std::sqrt(3.0) * 0.0002, 1e-12);
  EXPECT_NEAR(solved.known_to.position_mm, 0.3, 1e-12);
  EXPECT_EQ(solved.known_to.rotation_rad, site().known_to.rotation_rad) << "no turn was solved";
}

TEST(SolvedScene, AnUnsolvedHeightKeepsItsUncertainty) {
  Scene s = scene();
  know(s, 2, MarkerShape::kHeight, 0.2);  // only the depth of the target
  const Site solved = solved_site(site(), s);
  EXPECT_EQ(solved.markers[2].z_mm, -30.0);
  EXPECT_FALSE(solved.markers[0].z_mm.has_value());
  EXPECT_EQ(solved.known_to.height_mm, site().known_to.height_mm);  // also applies to the references
  know(s, 0, MarkerShape::kHeight, 0.4);
  know(s, 1, MarkerShape::kHeight, 0.3);
  EXPECT_NEAR(solved_site(site(), s).known_to.height_mm, 0.4, 1e-12);
  know(s, 2, MarkerShape::kHeight, 20.0);  // too uncertain for height_mm
  EXPECT_FALSE(solved_site(site(), s).markers[2].z_mm.has_value());
}

TEST(SolvedScene, ItsSiteReadsBackFromAFile) {
  const Site solved = solved_site(site(), scene());
  const auto read = parse_site(write_site(solved), "site.toml");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->markers[0].grating->pitch_mm, solved.markers[0].grating->pitch_mm);
  EXPECT_DOUBLE_EQ(read->markers[1].grating->angle_rad, solved.markers[1].grating->angle_rad);
  EXPECT_EQ(read->markers[1].circle->centre.x, solved.markers[1].circle->centre.x);
}

}  // namespace
}  // namespace moiregauge::internal
