// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/own_blur.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "moiregauge/observation/print/picture_for_tests.h"

namespace moiregauge::internal {
namespace {

using Complex = std::complex<double>;
using test::crossed_lines, test::print, test::seen, test::Shift, test::shift_of, test::upright;

constexpr int kLineOrder = 5;

double sinc(double x) { return x == 0.0 ? 1.0 : std::sin(kPi * x) / (kPi * x); }

// Returns lines along both axes, shifted by (x, y) pitches and smeared over `smear` pitches along x.
PrintSeries smeared(double x, double y, double smear) {
  std::vector<Complex> series;
  for (int n = -kLineOrder; n <= kLineOrder; ++n) {
    for (int m = -kLineOrder; m <= kLineOrder; ++m) {
      const double level = (m == 0) == (n == 0) ? 0.0 : 20.0 / (m * m + n * n);
      series.push_back(level * sinc(m * smear) * std::polar(1.0, kTwoPi * (m * x + n * y)));
    }
  }
  return {kLineOrder, series};
}

// A smear over 0.45 pitch inverts the third harmonic. Its phase is then off by pi.
TEST(OwnBlur, ASmearMovesNoPhase) {
  const TemplateNoise noise{1.0, 10000.0};
  for (const double smear : {0.0, 0.1, 0.45}) {
    const auto shift = shift_by_phases(smeared(0.0, 0.0, 0.0), noise, smeared(0.03, -0.02, smear), noise, {});
    ASSERT_TRUE(shift) << smear;
    EXPECT_NEAR(shift->at.x, 0.03, 1e-9) << smear;
    EXPECT_NEAR(shift->at.y, -0.02, 1e-9) << smear;
    EXPECT_LT(shift->chi2_dof, 1e-9) << smear;
  }
}

// Every harmonic has a phase variance of 2 x 1 / (2 N |c|^2), which makes the information a sum over the half plane.
TEST(OwnBlur, TheInformationOfAShiftIsThatOfItsHarmonics) {
  const double pixels = 10000.0;
  const PrintSeries same = smeared(0.0, 0.0, 0.0);
  const auto shift = shift_by_phases(same, {1.0, pixels}, same, {1.0, pixels}, {});
  ASSERT_TRUE(shift);
  double expected = 0.0;
  for (int m = 1; m <= kLineOrder; ++m)
    expected += std::pow(kTwoPi * m, 2) * pixels * std::norm(same.coefficient(m, 0));
  EXPECT_NEAR(shift->information(0, 0) / expected, 1.0, 1e-9);
}

// A shift of only one harmonic is no shift of the grating. The phases then disagree by many times their u.
TEST(OwnBlur, PhasesThatDisagreeAreReported) {
  const PrintSeries then = smeared(0.0, 0.0, 0.0);
  std::vector<Complex> series;
  for (int n = -kLineOrder; n <= kLineOrder; ++n) {
    for (int m = -kLineOrder; m <= kLineOrder; ++m)
      series.push_back(then.coefficient(m, n) * (std::abs(m) == 2 ? std::polar(1.0, 0.4 * m) : 1.0));
  }
  const TemplateNoise noise{1.0, 10000.0};
  const auto shift = shift_by_phases(then, noise, PrintSeries(kLineOrder, series), noise, {});
  ASSERT_TRUE(shift);
  EXPECT_GT(shift->chi2_dof, 10.0);
}

// Returns crossed lines as a camera sees them that moves by (dx, dy) px during the exposure.
Image<std::uint8_t> moving(double dx, double dy, std::uint64_t seed) {
  constexpr int kSteps = 24;
  return seen(
      [&](double x, double y) {
        double sum = 0.0;
        for (int k = 0; k < kSteps; ++k) {
          const double at = (k + 0.5) / kSteps - 0.5;
          sum += crossed_lines(x + at * dx, y + at * dy);
        }
        return sum / kSteps;
      },
      seed);
}

struct Reading {
  PatchFit at_rest, first, own;
  PrintFromImage map;
};

// Reads a picture (`now`) by the template of another one.
Reading read(const Image<std::uint8_t>& then, const Image<std::uint8_t>& now, double rounding = 0.0) {
  const auto model = learn_print(then.view(), upright(), print(), {.use = TemplateUse::kOn});
  EXPECT_TRUE(model);
  Reading out;
  out.map = model->correction * *local_map(upright(), print(), {});
  out.at_rest = read_points(then.view(), upright(), {print()}, *model).value();
  out.first = read_points(now.view(), upright(), {print()}, *model).value();
  out.own = fit_in_own_blur(now.view(), *model, out.at_rest, out.first, rounding).value_or(out.first);
  return out;
}

// The lines move by 5 px and 3 px during the exposure, a quarter of a pitch. The residual falls to the noise.
// The limit is 4 standard errors of 7000 pixels. u follows the residual and the edges that the blur leaves.
TEST(OwnBlur, ADiagonalSmearOfAQuarterPitchLeavesTheNoise) {
  const auto sharp = moving(0.0, 0.0, 1), blurred = moving(5.0, 3.0, 2);
  for (const auto& [then, now] : {std::pair(&sharp, &blurred), std::pair(&blurred, &sharp)}) {
    const Reading reading = read(*then, *now);
    const double noise = std::hypot(test::kNoise, 1.0 / std::sqrt(12.0));
    EXPECT_GT(reading.first.sigma, 3.0 * noise);
    EXPECT_NEAR(reading.own.sigma / noise, 1.0, 0.034);
    const Shift before = shift_of(reading.first, reading.map), after = shift_of(reading.own, reading.map);
    EXPECT_LT(after.u, before.u / 2.0);
    EXPECT_GT(after.u, 0.0);
  }
}

// Each error is that of two pictures. The rms of 16 errors has u = 18 %, and 3 of these are allowed. The harmonics that
// the blur removed count too much by 20 % at most, because both templates weigh equally.
TEST(OwnBlur, TheScatterOfSmearedPicturesAgreesWithTheirU) {
  double squares = 0.0, variances = 0.0;
  constexpr int kPictures = 16;
  for (std::uint64_t k = 0; k < kPictures; ++k) {
    const Reading reading = read(moving(4.0, 3.0, 100 + k), moving(-1.0, 2.0, 200 + k));
    const Shift then = shift_of(reading.at_rest, reading.map), now = shift_of(reading.own, reading.map);
    squares += std::pow(now.pitches - then.pitches, 2);
    variances += then.u * then.u + now.u * now.u;
  }
  EXPECT_LT(std::sqrt(squares / variances), 1.2 * (1.0 + 3.0 * 0.18));
  EXPECT_GT(std::sqrt(squares / variances), 1.0 - 3.0 * 0.18);
}

TEST(OwnBlur, TheSameBlurKeepsItsFit) {
  const Reading reading = read(moving(3.0, 1.0, 3), moving(3.0, 1.0, 4));
  EXPECT_EQ(reading.own.sigma, reading.first.sigma);
  EXPECT_EQ(reading.own.print[4].x, reading.first.print[4].x);
}

// The codec may leave all of the residual. The change of blur that was fitted explains it nevertheless.
TEST(OwnBlur, ASmearIsFoundBehindACodec) {
  const auto sharp = moving(0.0, 0.0, 1), blurred = moving(5.0, 3.0, 2);
  EXPECT_LT(read(sharp, blurred, 100.0).own.sigma, 0.4 * read(sharp, blurred, 100.0).first.sigma);
}

// Errors in the period of the grating, 2 grey levels rms. They enlarge the residual, and a template of the frame would
// contain them. No blur makes them, because it keeps the symmetry of the lines.
TEST(OwnBlur, ErrorsThatACodecMayLeaveAreNoBlur) {
  const auto clean = moving(0.0, 0.0, 5);
  auto coded = moving(0.0, 0.0, 6);
  for (int y = 0; y < coded.height(); ++y) {
    for (int x = 0; x < coded.width(); ++x) {
      const double error =
          4.0 * std::sin(kTwoPi * 3.0 * x / test::kPitchPx) * std::sin(kTwoPi * 2.0 * y / test::kPitchPx);
      coded.at(x, y) = static_cast<std::uint8_t>(std::clamp(std::round(coded.at(x, y) + error), 0.0, 255.0));
    }
  }
  const Reading as_codec = read(clean, coded, 4.0), as_blur = read(clean, coded);
  EXPECT_EQ(as_codec.own.sigma, as_codec.first.sigma);
  EXPECT_LT(as_blur.own.sigma, 0.8 * as_blur.first.sigma);
}

}  // namespace
}  // namespace moiregauge::internal
