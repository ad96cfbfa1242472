// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/planning/layout_bound.h"

#include <cmath>
#include <complex>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "moiregauge/phase/sampling_moire/sampling_moire.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr double kBoundPitch_mm = 10.0, kPixels = 6400.0, kSigma = 1.5;

Grating grating(double angle_rad = 0.0, Pattern pattern = Pattern::kGrid) {
  return {{0.0, 0.0}, 40.0, 40.0, kBoundPitch_mm, angle_rad, pattern};
}

// Four references at (+-a, +-b), each with noise s along both axes.
std::vector<ReadPlace> four(double a, double b, double s) {
  std::vector<ReadPlace> places;
  for (const BoardPoint at : {BoardPoint{-a, b}, {a, b}, {-a, -b}, {a, -b}})
    places.push_back({at, Matrix2::Identity() / (s * s)});
  return places;
}

// Rife and Boorstyn 1974: variance of a phase = 2 sigma^2 / (amplitude^2 N).
TEST(LayoutBound, FundamentalsGiveThePhaseBound) {
  const auto print = PrintTemplate::cosine(60.0, 30.0);
  const Matrix2 information = shift_information(grating(), print, kPixels, kSigma, Bound::kPhase);
  const auto u = [&](double amplitude) { return kBoundPitch_mm / kTwoPi * phase_bound(kSigma, amplitude, kPixels); };
  EXPECT_NEAR(1.0 / std::sqrt(information(0, 0)) / u(60.0), 1.0, 1e-9);
  EXPECT_NEAR(1.0 / std::sqrt(information(1, 1)) / u(30.0), 1.0, 1e-9);
  // A rotation by a quarter turn exchanges the axes.
  const Matrix2 turned = shift_information(grating(0.5 * kPi), print, kPixels, kSigma, Bound::kPhase);
  EXPECT_NEAR(turned(0, 0) / information(1, 1), 1.0, 1e-9);
}

// A third harmonic with a third of the amplitude has the slopes of the fundamental.
TEST(LayoutBound, EveryHarmonicAddsItsSlopes) {
  std::vector<std::complex<double>> series(49);
  const auto set = [&](int m, double c) { series[static_cast<std::size_t>(3 * 7 + m + 3)] = c; };
  set(1, 30.0), set(-1, 30.0), set(3, 10.0), set(-3, 10.0);
  const PrintTemplate print(3, series);
  const double phase = shift_information(grating(), print, kPixels, kSigma, Bound::kPhase)(0, 0);
  const double full = shift_information(grating(), print, kPixels, kSigma, Bound::kFull)(0, 0);
  EXPECT_NEAR(full / phase, 2.0, 1e-9);
}

// u_x = (s/2) sqrt(1 + (a/b)^2) in the middle of four references at (+-a, +-b) (reference_weights.h).
TEST(LayoutBound, ThroughAHomographyOfFourFollowsTheClosedForm) {
  constexpr double a = 340.0, b = 28.0, s = 0.001;
  const auto c = through_homography(four(a, b, s), {0.0, 0.0});
  ASSERT_TRUE(c);
  EXPECT_NEAR(std::sqrt((*c)(0, 0)), 0.5 * s * std::sqrt(1.0 + a * a / (b * b)), 1e-9);
  EXPECT_NEAR(std::sqrt((*c)(1, 1)), 0.5 * s * std::sqrt(1.0 + b * b / (a * a)), 1e-9);
}

// A pose is a homography with six parameters. Stretch and shear are two more, which do not affect the middle of four
// references. There only y separates a tilt from a shift. Away from the middle they increase the variance.
TEST(LayoutBound, APoseIsNeverWorseThanAHomographyAndNeedsThree) {
  const auto places = four(340.0, 28.0, 0.001);
  const Eigen::Vector3d camera(0.0, 0.0, 1200.0);
  const auto variances = [&](BoardPoint p) {
    return std::pair{through_homography(places, p).value(), through_pose(places, p, camera).value()};
  };
  const auto [free, rigid] = variances({0.0, 0.0});
  EXPECT_NEAR(rigid(0, 0) / free(0, 0), 1.0, 1e-6);
  EXPECT_NEAR(rigid(1, 1) / free(1, 1), 1.0, 1e-6);
  const auto [free_outside, rigid_outside] = variances({0.0, 60.0});
  EXPECT_LE(rigid_outside(0, 0), free_outside(0, 0) * (1.0 + 1e-9));
  EXPECT_LT(rigid_outside(1, 1), 0.5 * free_outside(1, 1));
  const std::span<const ReadPlace> three(places.data(), 3);
  EXPECT_FALSE(through_homography(three, {0.0, 0.0}));
  EXPECT_TRUE(through_pose(three, {0.0, 0.0}, camera));
}

TEST(LayoutBound, ReferencesOnALineDetermineNothing) {
  std::vector<ReadPlace> line;
  for (const double x : {-300.0, -100.0, 100.0, 300.0}) line.push_back({{x, 20.0}, Matrix2::Identity()});
  EXPECT_FALSE(through_homography(line, {0.0, 0.0}));
}

}  // namespace
}  // namespace moiregauge::internal
