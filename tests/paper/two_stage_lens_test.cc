// SPDX-License-Identifier: Apache-2.0
// Tests the paper's cases through a real lens. The errors equal those of exact points, so they belong to the method and
// not to this program.
#include <cmath>

#include <gtest/gtest.h>

#include "common/simulated_run.h"
#include "paper/exact_points.h"

namespace moiregauge::internal {
namespace {

simulator::Scenario with_lens(const char* name, double k1) {
  auto scenario = *simulator::built_in(name);
  scenario.camera.k1 = k1;
  scenario.sensor.exposure_s = 1e-6;  // the exact points are those of one instant
  return scenario;
}

TEST(TwoStageThroughALens, TheResidualIsThatOfTheExactPoints) {
  for (const auto& [name, reference] : {std::pair{"rig-1x", 0L}, {"rig-8xyz", 80L}}) {
    const auto scenario = with_lens(name, test::kMinusOnePercent);
    test::RunPlan plan;
    plan.grain = test::Grain::kNoiseFree;
    plan.step = 10;
    plan.reference_frame = reference;
    const auto run = test::measured(scenario, plan);
    ASSERT_TRUE(run.problem.empty()) << run.problem;
    std::vector<double> exact, circles_only, difference;
    for (std::size_t i = 0; i < run.samples.size(); ++i) {
      const long frame = run.samples[i].frame;
      exact.push_back(1000.0 * test::exact_error(scenario, frame, reference, test::Stages::kBoth).y);
      circles_only.push_back(1000.0 * test::exact_error(scenario, frame, reference, test::Stages::kCirclesOnly).y);
      difference.push_back(run.error_y_um[i] - exact.back());
    }
    EXPECT_LE(test::rms(difference), 0.05 * test::rms(exact))
        << name << ": measured " << test::rms(run.error_y_um) << " um, exact " << test::rms(exact);
    // The test would notice a missing second stage.
    const double factor = test::rms(circles_only) / test::rms(exact);
    EXPECT_GT(factor, 1.1) << name;
    EXPECT_LT(factor, 1.35) << name;
    RecordProperty(name, std::to_string(test::rms(run.error_y_um)) + " um, exact " + std::to_string(test::rms(exact)));
  }
}

TEST(TwoStageThroughALens, UncertaintyCoversWhatItCannotAbsorb) {
  for (const auto& [name, reference] : {std::pair{"rig-1x", 0L}, {"rig-1xyz", 0L}, {"rig-8xyz", 80L}}) {
    test::RunPlan plan;
    plan.step = 8;
    plan.reference_frame = reference;
    const auto run = test::measured(with_lens(name, test::kMinusOnePercent), plan);
    ASSERT_TRUE(run.problem.empty()) << run.problem;
    long lies = 0;  // `ok`, and wrong by more than 5 u and 0.5 um
    std::size_t k = 0;
    for (const Sample& s : run.samples) {
      const double e = std::abs(run.error_y_um[k]), u = run.u_y_um[k];
      lies += s.status == Status::kOk && e > 5.0 * u && e > 0.5;
      ++k;
    }
    EXPECT_EQ(lies, 0) << name;
    // The stated uncertainty is of the size of the error, neither far smaller nor far larger.
    EXPECT_GT(test::rms(run.u_y_um), 0.6 * test::rms(run.error_y_um)) << name;
    EXPECT_LT(test::rms(run.u_y_um), 2.0 * test::rms(run.error_y_um)) << name;
  }
}

}  // namespace
}  // namespace moiregauge::internal
