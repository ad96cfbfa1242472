// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/scenario/track.h"

#include <gtest/gtest.h>

#include "moiregauge/simulator/scenario/built_in.h"

namespace moiregauge::internal::simulator {
namespace {

TEST(PaperMotion, GoesUpTwoMillimetresAndComesBack) {
  const Track motion = paper_motion();
  EXPECT_EQ(motion.at(-1.0), 0.0);
  EXPECT_EQ(motion.at(1.0), 0.5);
  EXPECT_EQ(motion.at(3.0), 1.0);
  EXPECT_EQ(motion.at(7.0), 2.0);
  EXPECT_EQ(motion.at(11.0), 1.0);
  EXPECT_EQ(motion.at(16.0), 0.0);
}

TEST(Track, TheMeanIsTheIntegralDividedByTheTime) {
  Track track = paper_motion();
  track.amplitude = 0.3;
  track.frequency_hz = 4.0;
  track.phase_deg = 20.0;
  double sum = 0.0;
  constexpr int kSteps = 200000;
  for (int i = 0; i < kSteps; ++i) sum += track.at(1.9 + 0.33 * (i + 0.5) / kSteps);
  EXPECT_NEAR(track.mean(1.9, 2.23), sum / kSteps, 1e-9);
}

}  // namespace
}  // namespace moiregauge::internal::simulator
