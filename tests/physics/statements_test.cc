// SPDX-License-Identifier: Apache-2.0
// Tests statements of the user: accepted if the footage agrees, contradicted if it does not.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "common/simulated_run.h"

namespace moiregauge::internal {
namespace {

simulator::Scenario scenario_of(const char* name, double k1 = -0.37) {
  auto scenario = *simulator::built_in(name);
  scenario.camera.k1 = k1;  // -0.37: -1 % at the image corner
  return scenario;
}

simulator::Scenario at_rest(simulator::Scenario scenario) {
  scenario.markers.back().dx = scenario.markers.back().dy = simulator::Track{};
  return scenario;
}

test::MeasuredRun measured_with_rest(const simulator::Scenario& scenario, FrameRange rest) {
  test::RunPlan plan{.method = "precise", .frames = rest.end + 2};
  plan.solve.rest = rest;
  return test::measured(scenario, plan);
}

// The target moves by 0.95 mm in 20 frames. With a camera that travels by 5 mm, another depth could explain a part of
// it.
TEST(StatedRest, IsContradictedIfATargetMoves) {
  const auto run = measured_with_rest(scenario_of("small-travel-5"), {.first = 0, .end = 20});
  ASSERT_TRUE(run.solution.moved_at_rest);
  const MovedAtRest& moved = *run.solution.moved_at_rest;
  EXPECT_EQ(run.reference.site.markers[moved.marker].name, "mid");
  EXPECT_GT(moved.mm, 0.5);
  EXPECT_LT(moved.mm, 1.0);
  EXPECT_LT(moved.u_mm, 0.01);
  EXPECT_LT(moved.from, moved.to);
  EXPECT_LT(moved.to, 20);
  // The samples are those without the statement.
  EXPECT_LE(test::largest(run.error_y_um), 5.0 * test::rms(run.u_y_um));
}

// u of a reading is 0.3 um here.
TEST(StatedRest, IsContradictedIfATargetSwingsByMicrometres) {
  for (const double amplitude_mm : {0.02, 0.003}) {
    auto scenario = at_rest(scenario_of("small-1xyz"));
    scenario.markers.back().dy.amplitude = amplitude_mm, scenario.markers.back().dy.frequency_hz = 1.3;
    const auto run = measured_with_rest(scenario, {.first = 0, .end = 20});
    ASSERT_TRUE(run.solution.moved_at_rest) << amplitude_mm;
    EXPECT_NEAR(run.solution.moved_at_rest->mm, 2.0 * amplitude_mm, 0.001 + 0.1 * amplitude_mm);
  }
}

// The target is 30 mm behind the plane, unknown to the site. A camera that travels by 50 mm makes it appear to move by
// 1.2 mm.
TEST(StatedRest, IsAcceptedIfOnlyTheCameraMoves) {
  for (const char* name : {"small-still", "small-travel-5", "small-travel-50"}) {
    const auto run = measured_with_rest(at_rest(scenario_of(name)), {.first = 0, .end = 10});
    EXPECT_FALSE(run.solution.moved_at_rest) << name;
  }
}

// A grating half a per cent too large looks 6 mm nearer, until the rest frames show its position.
TEST(StatedRest, IsAcceptedIfAWrongPrintScaleChangedTheDepth) {
  auto scenario = at_rest(scenario_of("small-travel-50"));
  scenario.known_to.print_scale = 0.005;
  scenario.markers.back().place.print_scale = 0.005;
  const auto run = measured_with_rest(scenario, {.first = 0, .end = 10});
  EXPECT_FALSE(run.solution.moved_at_rest);
}

constexpr double kNotStated = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<double, kCameraParameters> kWellKnown{3.0, 1.0, 1.0, 0.001, 0.01, 1e-5, 1e-5, kNotStated};

test::MeasuredRun measured_with_camera(const simulator::Scenario& scenario, double k1) {
  test::RunPlan plan{.method = "precise", .step = 3, .frames = 34};
  plan.lens.width = scenario.camera.width, plan.lens.height = scenario.camera.height;
  plan.lens.fx = plan.lens.fy = scenario.camera.fx;
  plan.lens.cx = scenario.camera.cx, plan.lens.cy = scenario.camera.cy;
  plan.lens.k1 = k1;
  plan.solve.u_camera = kWellKnown;
  return test::measured(scenario, plan);
}

TEST(GivenCamera, IsContradictedIfWrongAndNoRowIsOk) {
  for (const double k1 : {0.3, -0.37}) {
    const auto run = measured_with_camera(scenario_of("small-1xyz", 0.0), k1);
    EXPECT_TRUE(notes(run, "no row is trusted: with --camera")) << k1;
    EXPECT_FALSE(notes(run, "references moves")) << k1;
    for (const Sample& s : run.samples) EXPECT_NE(s.status, Status::kOk) << "frame " << s.frame;
  }
}

TEST(GivenCamera, IsAcceptedIfRight) {
  for (const char* name : {"small-1xyz", "small-travel-50"}) {
    const auto run = measured_with_camera(scenario_of(name), -0.37);
    EXPECT_FALSE(notes(run, "with --camera")) << name;
    for (const Sample& s : run.samples) EXPECT_EQ(s.status, Status::kOk) << name << " frame " << s.frame;
  }
}

// Largest movement towards the camera that a run states, and its u. NaN: none.
struct StatedHeight {
  double mm = kNotStated, u_mm = kNotStated;
};

StatedHeight largest_height(const test::MeasuredRun& run) {
  StatedHeight out;
  for (const std::string& line : run.solution.findings) {
    const std::size_t at = line.find("by up to ");
    if (line.find("towards or away") != std::string::npos)
      std::sscanf(line.c_str() + at, "by up to %lf mm (u %lf mm)", &out.mm, &out.u_mm);
  }
  return out;
}

// A fixed camera does not show its focal length, so that of --camera counts. A height by size is proportional to it. The
// given one is wrong by 1 %, which is 2 u of a camera file without u.
TEST(GivenCamera, DeterminesHowFarATargetMovesTowardsIt) {
  constexpr double kSwing_mm = 15.0;
  for (const double factor : {0.99, 1.0, 1.01}) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      auto scenario = at_rest(scenario_of("small-still"));
      scenario.seed = seed;
      scenario.markers.back().dz.amplitude = kSwing_mm, scenario.markers.back().dz.frequency_hz = 0.5;
      test::RunPlan plan{.method = "precise", .frames = 11};
      const simulator::Camera& c = scenario.camera;
      plan.lens = {c.width, c.height, c.fx * factor, c.fy * factor, c.cx, c.cy, c.k1 * factor * factor, 0, 0, 0, 0};
      const StatedHeight found = largest_height(test::measured(scenario, plan));
      EXPECT_LT(found.u_mm, 0.01 * kSwing_mm) << "seed " << seed;
      EXPECT_NEAR(found.mm, kSwing_mm, 3.0 * found.u_mm) << factor << ", seed " << seed;
    }
  }
}

// The target is 30 mm behind the plane. Stated as in the plane to 0.01 mm, it would bend the focal length until the
// parallax of 50 mm of travel agrees.
TEST(StatedHeight, IsContradictedIfWrongAndNoRowIsOk) {
  const auto scenario = scenario_of("small-travel-50", 0.0);
  for (const double height_mm : {-30.0, 0.0}) {
    test::RunPlan plan{.method = "precise", .frames = 12};
    plan.site = simulator::site_of(scenario);
    plan.site->known_to.height_mm = 0.01;
    plan.site->markers.back().z_mm = height_mm;
    const auto run = test::measured(scenario, plan);
    const bool is_wrong = height_mm == 0.0;
    EXPECT_EQ(notes(run, "no row is trusted: with z_mm"), is_wrong) << height_mm;
    for (const Sample& s : run.samples) EXPECT_EQ(s.status != Status::kOk, is_wrong) << "frame " << s.frame;
  }
}

bool finds(const test::MeasuredRun& run, const std::string& what) {
  for (const std::string& line : run.solution.findings) {
    if (line.find(what) != std::string::npos) return true;
  }
  return false;
}

// 11 mm stated, 10 mm printed: a grating of 11 mm would look like that 120 mm further away (1200 mm x 1.1 - 1200 mm).
TEST(ApparentSize, ContradictsAPitchStatedATenthTooLarge) {
  const auto scenario = scenario_of("small-1xyz", 0.0);
  Site site = simulator::site_of(scenario);
  site.markers.back().grating->pitch_mm = 11.0;
  test::RunPlan plan{.method = "precise", .step = 8, .frames = 16};
  plan.site = site;
  const auto run = test::measured(scenario, plan);
  EXPECT_TRUE(finds(run, "'mid' may be wrong by 9")) << ::testing::PrintToString(run.solution.findings);
  EXPECT_TRUE(finds(run, "its pitch is 10")) << ::testing::PrintToString(run.solution.findings);
  EXPECT_TRUE(finds(run, "further away")) << ::testing::PrintToString(run.solution.findings);
  // The depth is wrong by sqrt(2) u, and it bends the solved lens and poses too. No row is off by 5 u (a lie).
  for (std::size_t i = 0; i < run.error_y_um.size(); ++i)
    EXPECT_LT(std::abs(run.error_y_um[i]), 5.0 * run.u_y_um[i]) << "row " << i;
  EXPECT_GT(test::largest(run.error_y_um), 50.0);
}

TEST(ApparentSize, AgreesWithGratingsAtTheirStatedDepth) {
  EXPECT_FALSE(
      finds(test::measured(scenario_of("small-1xyz"), {.method = "precise", .step = 8, .frames = 16}), "looks"));
}

}  // namespace
}  // namespace moiregauge::internal
