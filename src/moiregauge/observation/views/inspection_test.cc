// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/views/inspection.h"

#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// Returns the bound of a displacement, px. The Fisher information is summed pixel by pixel over an image of the
// fundamentals.
double displacement_bound_of(bool checkerboard, double pitch, int pitches, double amplitude, double sigma) {
  double information = 0.0;
  const int side = static_cast<int>(pitch) * pitches;
  const double k = kTwoPi / pitch;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const double slope = checkerboard ? amplitude * k * (std::sin(k * (x + y)) + std::sin(k * (x - y)))
                                        : amplitude * k * std::sin(k * x);
      information += slope * slope / (sigma * sigma);
    }
  }
  return std::sqrt(2.0 / information);  // difference of two such frames
}

TEST(Inspection, ASinglePatchReachesTheFisherInformation) {
  constexpr double kPitch = 20.0, kAmplitude = 50.0, kSigma = 2.0;
  InspectedPatch patch;
  patch.seen.k_x = {1.0 / kPitch, 0.0};
  patch.seen.k_y = {0.0, -1.0 / kPitch};
  patch.seen.modulation = kAmplitude;
  patch.noise.sigma = kSigma;
  patch.pixels = 100.0 * 100.0;
  const double crossed = displacement_bound_of(false, kPitch, 5, kAmplitude, kSigma);
  EXPECT_NEAR(displacement_bound(patch).along_x_px, crossed, 1e-9 * crossed);
  EXPECT_NEAR(displacement_bound(patch).along_y_px, crossed, 1e-9 * crossed);
  patch.seen.pattern = Pattern::kCheckerboard;
  const double checker = displacement_bound_of(true, kPitch, 5, kAmplitude, kSigma);
  EXPECT_NEAR(displacement_bound(patch).along_x_px, checker, 1e-9 * checker);
  patch.seen.pattern = Pattern::kLinesX;
  EXPECT_NEAR(displacement_bound(patch).along_x_px, crossed, 1e-9 * crossed);
  EXPECT_TRUE(std::isnan(displacement_bound(patch).along_y_px)) << "lines show nothing along themselves";
}

}  // namespace
}  // namespace moiregauge::internal
