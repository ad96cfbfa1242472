// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/model/fast_vibration.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr double kPitch_mm = 10.0;   // mm
constexpr double kTime = 0.005;      // s, from the middle of the readout to the references
constexpr double kAmplitude = 0.03;  // mm, of the vibration along x
constexpr int kFrames = 24;

Site two_references() {
  Site site;
  for (int i = 0; i < 2; ++i) {
    Marker m;
    m.role = Role::kReference;
    m.grating = Grating{{}, 60.0, 60.0, kPitch_mm, 0.0, Pattern::kGrid};
    site.markers.push_back(m);
  }
  return site;
}

// Frames that see the vibration at evenly spaced phases. Its rate and acceleration are known, and the path has no part
// of it. The first coordinate moves the references along x.
std::vector<MotionBeyondPath> seen_at(double w, double amplitude_mm = kAmplitude) {
  std::vector<MotionBeyondPath> out;
  for (int k = 0; k < kFrames; ++k) {
    MotionBeyondPath seen;
    const double phase = kTwoPi * k / kFrames;
    seen.motion = Motion::Zero();
    seen.motion(0) = amplitude_mm / kPitch_mm * w * std::cos(phase);
    seen.motion(kMotionParameters / 2) = -amplitude_mm / kPitch_mm * w * w * std::sin(phase);
    seen.frame.points.assign(2, PatchFit{});
    seen.frame.rows.emplace();
    for (const double t : {-kTime, kTime}) {
      RowDesign::Columns columns = RowDesign::Columns::Zero();
      columns.col(0).head<kPatchPoints>().setConstant(t);
      columns.col(kMotionParameters / 2).head<kPatchPoints>().setConstant(0.5 * t * t);
      seen.frame.rows->by_marker.push_back(columns);
    }
    out.push_back(std::move(seen));
  }
  return out;
}

// Returns what rate and acceleration leave of the vibration at the references, rms over the phases.
double remainder_mm(double w) {
  const double wt = w * kTime;
  const double by_sine = std::cos(wt) - 1.0 + 0.5 * wt * wt, by_cosine = std::sin(wt) - wt;
  return kAmplitude * std::sqrt(0.5 * (by_sine * by_sine + by_cosine * by_cosine));
}

// Angles w t of 0.3, 1 and 1.5 rad are 10, 32 and 48 Hz at 5 ms. Rate and acceleration leave 0.1, 3.5 and 11 um of 30 um.
// The next term of the sine exceeds that by at most 14 % up to 1 rad, and above it u may be twice as large.
TEST(FastVibration, UContainsWhatRateAndAccelerationLeave) {
  for (const double wt : {0.3, 1.0, 1.5}) {
    const double w = wt / kTime;
    const auto u = fast_vibration(two_references(), seen_at(w), 3.0).u_mm;
    EXPECT_GT(u.x / remainder_mm(w), 1.0) << wt;
    EXPECT_LT(u.x / remainder_mm(w), wt > 1.0 ? 2.0 : 1.15) << wt;
    EXPECT_EQ(u.y, 0.0) << wt;
  }
}

TEST(FastVibration, UIsAtMostTheDisplacementBeyondThePath) {
  constexpr double kWt = 6.0;
  const double displaced = kAmplitude * std::sqrt(0.5 * (kWt * kWt + 0.25 * std::pow(kWt, 4)));
  EXPECT_NEAR(fast_vibration(two_references(), seen_at(kWt / kTime), 3.0).u_mm.x, displaced, 1e-9);
}

// At w t = 1.5 rad, amplitudes of 30 and 300 um displace by 0.004 and 0.04 pitch. At 0.5 rad the rows show the vibration,
// and 3 mm displace by 0.11 pitch. Then it is too large only if the frames contradict the scene.
TEST(FastVibration, IsTooLargeIfTheRowsDoNotShowItOrTheFramesDoNotFit) {
  const auto is_too_large = [](double wt, double amplitude_mm, double chi2_dof) {
    return fast_vibration(two_references(), seen_at(wt / kTime, amplitude_mm), chi2_dof).is_too_large;
  };
  EXPECT_FALSE(is_too_large(1.5, 0.03, 3.0));
  EXPECT_TRUE(is_too_large(1.5, 0.3, 3.0));
  EXPECT_FALSE(is_too_large(0.5, 3.0, 3.0));
  EXPECT_FALSE(is_too_large(0.5, 0.3, 100.0));
  EXPECT_TRUE(is_too_large(0.5, 3.0, 100.0));
}

TEST(FastVibration, IsZeroForMotionOnThePathOrThatItDescribes) {
  EXPECT_EQ(fast_vibration(two_references(), seen_at(1.5 / kTime, 0.3), 1.4).u_mm.x, 0.0);
  EXPECT_FALSE(fast_vibration(two_references(), seen_at(1.5 / kTime, 0.3), 1.4).is_too_large);
  EXPECT_EQ(fast_vibration(two_references(), seen_at(0.0), 3.0).u_mm.x, 0.0);
  EXPECT_EQ(fast_vibration(two_references(), {}, 3.0).u_mm.x, 0.0);
}

}  // namespace
}  // namespace moiregauge::internal
