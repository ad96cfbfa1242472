// SPDX-License-Identifier: Apache-2.0
// Tests the paper's cases with `precise` and an unknown lens: only the noise of the pixels remains.
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "common/simulated_run.h"
#include "moiregauge/phase/sampling_moire/sampling_moire.h"
#include "moiregauge/planning/reference_weights.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

struct PreciseCase {
  const char* scenario;
  long reference_frame;
  double k1;  // -0.0225 is -1 % at the sensor's corner
};

// Returns the phase bound of a displacement in one frame, um. It uses the fundamental of every grating over all of its
// pixels, and the homography through all references. The lines are binary, 210 on 40, with the rig's PSF, noise and
// rounding.
Extent<frame::Board> phase_bound_um(const simulator::Scenario& scenario) {
  const Site site = simulator::site_of(scenario);
  const double mm_per_px = scenario.mount.distance_mm / scenario.camera.fx;
  const double pitch_px = site.markers[0].grating->pitch_mm / mm_per_px;
  const double blur = std::hypot(scenario.sensor.psf_sigma_px, 1.0 / std::sqrt(12.0));
  const double amplitude = 0.5 * (2.0 / kPi) * (scenario.light.white - scenario.light.black) *
                           std::exp(-0.5 * std::pow(kTwoPi * blur / pitch_px, 2));
  const double noise = std::hypot(scenario.sensor.noise_sigma, 1.0 / std::sqrt(12.0));
  const auto u_um = [&](const Grating& g) {
    const double pixels = g.width_mm * g.height_mm / (mm_per_px * mm_per_px);
    return 1000.0 * g.pitch_mm / kTwoPi * phase_bound(noise, amplitude, pixels);
  };
  std::vector<BoardPoint> at;
  std::vector<Extent<frame::Board>> u;
  const Marker* target = nullptr;
  for (const Marker& m : site.markers) {
    if (m.role == Role::kTarget)
      target = &m;
    else
      at.push_back(m.grating->centre), u.push_back({u_um(*m.grating), u_um(*m.grating)});
  }
  const auto references = through_references(reference_weights(at, target->grating->centre), u);
  const double own = u_um(*target->grating);
  return {std::hypot(own, references.x), std::hypot(own, references.y)};
}

TEST(Precise, WithAnUnknownLensOnlyNoiseRemains) {
  for (const PreciseCase& c :
       {PreciseCase{"rig-0.1x", 0, -0.0225}, {"rig-1xyz", 0, -0.0451}, {"rig-8xyz", 80, -0.0225}}) {
    auto scenario = *simulator::built_in(c.scenario);
    scenario.camera.k1 = c.k1;
    test::RunPlan plan;
    plan.method = "precise";
    plan.step = 5;
    plan.reference_frame = c.reference_frame;
    const auto run = test::measured(scenario, plan);
    ASSERT_TRUE(run.problem.empty()) << run.problem;
    const auto bound = phase_bound_um(scenario);
    ASSERT_EQ(run.error_y_um.size(), run.samples.size()) << c.scenario;
    // The template contains all harmonics, so the scatter is below the bound of the fundamental.
    EXPECT_LE(test::scatter(run.error_y_um), 1.0 * bound.y) << c.scenario;
    EXPECT_LE(test::scatter(run.error_x_um), 1.0 * bound.x) << c.scenario;
    for (std::size_t k = 0; k < run.samples.size(); ++k) {
      EXPECT_EQ(run.samples[k].status, Status::kOk);
      EXPECT_LE(std::abs(run.error_y_um[k]), 5.0 * run.u_y_um[k]) << c.scenario << " frame " << run.samples[k].frame;
      EXPECT_LE(std::abs(run.error_x_um[k]), 5.0 * run.u_x_um[k]) << c.scenario << " frame " << run.samples[k].frame;
    }
    std::printf("%s k1 %.4f: dx %.2f (bound %.2f), dy %.3f (bound %.3f) um; raw %.2f %.3f; u %.2f %.2f\n", c.scenario,
                c.k1, test::scatter(run.error_x_um), bound.x, test::scatter(run.error_y_um), bound.y,
                test::rms(run.error_x_um), test::rms(run.error_y_um), test::rms(run.u_x_um), test::rms(run.u_y_um));
  }
}

}  // namespace
}  // namespace moiregauge::internal
