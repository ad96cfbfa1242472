// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/continuity.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

// Test result for a target of 10 mm pitch at these positions, frame by frame. NaN: not seen.
std::vector<bool> verdict(const std::vector<double>& y_mm) {
  Site site;
  for (const Role role : {Role::kReference, Role::kTarget}) {
    Marker marker;
    marker.role = role;
    marker.grating.emplace().pitch_mm = 10.0;
    site.markers.push_back(marker);
  }
  std::vector<FrameStart> frames;
  for (const double y : y_mm) {
    FrameStart frame;
    frame.shift = {{}, {0.0, y}};
    frame.has_points = {false, y == y};
    frames.push_back(frame);
  }
  return outruns_continuity(site, frames);
}

TEST(Continuity, HoldsForStepsBelowAQuarterPitchOverAnyDistance) {
  EXPECT_EQ(verdict({0.0, 2.4, 4.8, 7.2, 9.6, 12.0}), std::vector<bool>({false, false}));
}

TEST(Continuity, EndsWithOneLongerStepInEitherDirection) {
  EXPECT_TRUE(verdict({0.0, 1.0, 3.6, 3.7})[1]);
  EXPECT_TRUE(verdict({0.0, 0.1, -2.5})[1]);
}

TEST(Continuity, IsTestedAcrossFramesWithoutTheTarget) {
  const double unseen = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(verdict({0.0, unseen, unseen, 4.0})[1]);
  EXPECT_FALSE(verdict({0.0, unseen, unseen, 2.0})[1]);
}

// Two targets. The second one makes a large step between the third row and the fourth.
TEST(Continuity, FrameByFrameReadingsEndWithTheFirstLongStepOfThatTarget) {
  Site site;
  for (int i = 0; i < 2; ++i) {
    Marker marker;
    marker.role = Role::kTarget;
    marker.grating.emplace().pitch_mm = 10.0;
    site.markers.push_back(marker);
  }
  std::vector<Sample> samples;
  for (const double y_mm : {0.0, 2.4, 2.5, 5.2, 5.3}) {
    for (const std::size_t marker : {std::size_t{0}, std::size_t{1}}) {
      Sample sample;
      sample.marker = marker;
      sample.displacement = {0.0, marker == 1 ? y_mm : 0.5 * y_mm};
      sample.status = Status::kOk;
      samples.push_back(sample);
    }
  }
  doubt_after_leaps(site, samples);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const bool doubted = samples[n].marker == 1 && n >= 7;  // from the fourth row
    EXPECT_EQ(samples[n].status, doubted ? Status::kOrderUnproven : Status::kOk) << "sample " << n;
    EXPECT_EQ(std::isnan(samples[n].displacement.y), doubted) << "sample " << n;
  }
}

}  // namespace
}  // namespace moiregauge::internal
