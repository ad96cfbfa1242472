// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/model/rolling_shutter.h"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "moiregauge/calibration/scene/footage_for_tests.h"

namespace moiregauge::internal {
namespace {

using test::Angles, test::Footage, test::footage_of, test::kFootageSeed, test::lens, test::Recording;

// Fast sensors read all rows in a few milliseconds, at any frame rate. The camera turns by up to 10 deg/s about its
// axis.
TEST(SolveShutter, KeepsAGivenReadoutMuchShorterThanTheFrameInterval) {
  constexpr double kReadout = 0.006;  // s; frames are 43 ms apart
  const Recording truth{.camera = lens(-0.0225),
                        .angles =
                            [](double s) {
                              return Angles{2.0 * s, std::sin(5.0 * s), std::sin(10.0 * s)};
                            },
                        .readout_s = kReadout};
  const Footage run = footage_of(truth, 24);
  const ScenePrior prior = scene_prior(truth.site, truth.camera.width, truth.camera.height, std::nullopt);
  std::vector<std::size_t> key(run.frames.size());
  std::iota(key.begin(), key.end(), std::size_t{0});
  const Shutter solved = solve_shutter(truth.site, test::series_of(run.frames), key, prior, kReadout);
  ASSERT_EQ(solved.problem, "");
  EXPECT_FALSE(solved.bounded);
  EXPECT_NEAR(solved.readout_s / kReadout, 1.0, 2.0 * kGivenReadout) << "seed " << kFootageSeed;
}

}  // namespace
}  // namespace moiregauge::internal
