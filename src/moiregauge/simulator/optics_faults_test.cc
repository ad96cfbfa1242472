// SPDX-License-Identifier: Apache-2.0
// Faults of lens, light and sensor, compared with formulas of optics.
#include <algorithm>
#include <cmath>
#include <complex>

#include <gtest/gtest.h>

#include "moiregauge/simulator/faults_for_tests.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::simulator {
namespace {

// Returns the signed amplitude of the grating's first harmonic along x, relative to its middle.
double contrast(const Scenario& scenario, long frame = 0) {
  const Image<double> picture = render_ideal(scenario, frame);
  const ImagePoint middle = project(scenario, frame, scenario.markers[0], {0.0, 0.0});
  const double pitch = pitch_px(scenario);
  double sum = 0.0;
  // A Hann window two periods wide suppresses the mean.
  const int y = static_cast<int>(std::lround(middle.y)), reach = static_cast<int>(std::floor(pitch));
  for (int x = static_cast<int>(middle.x) - reach; x <= static_cast<int>(middle.x) + reach; ++x) {
    const double d = x - middle.x, window = std::abs(d) < pitch ? 1.0 + std::cos(kPi * d / pitch) : 0.0;
    sum += window * (picture.at(x, y) - 125.0) * std::cos(kTwoPi * d / pitch);
  }
  return sum;
}

// A Gaussian of sigma s multiplies a wave of period P by exp(-2 pi^2 s^2 / P^2).
TEST(Defocus, AGaussianLowersTheContrastByItsTransferFunction) {
  Scenario scenario = lines(Pattern::kCosine);
  const double sharp = contrast(scenario), pitch = pitch_px(scenario);
  for (const double sigma : {2.0, 5.0}) {
    scenario.sensor.defocus_px.offset = sigma;
    const double expected = std::exp(-0.5 * std::pow(kTwoPi * sigma / pitch, 2));
    EXPECT_NEAR(contrast(scenario) / sharp, expected, 0.01) << sigma << " px";
  }
}

// A disc of radius R multiplies a wave of period P by 2 J1(x) / x, with x = 2 pi R / P. Beyond R = 0.61 P this is
// negative: dark and light are exchanged.
TEST(Defocus, ALargeDiscExchangesLightAndDark) {
  Scenario scenario = lines(Pattern::kCosine);
  scenario.camera.height = 12;  // px; a disc is drawn point by point, which is slow
  scenario.camera.cy = 6.0;
  const double sharp = contrast(scenario), pitch = pitch_px(scenario);
  for (const double share : {0.2, 0.4, 0.8}) {
    scenario.sensor.defocus_disc_px.offset = share * pitch;
    const double x = kTwoPi * share, expected = 2.0 * std::cyl_bessel_j(1, x) / x;
    // The rim is soft by 0.12 of the radius. At equal variance the difference is of fourth order, below 0.03 here.
    EXPECT_NEAR(contrast(scenario) / sharp, expected, 0.03) << share << " pitch";
  }
}

TEST(Defocus, MayChangeOverTime) {
  Scenario scenario = lines(Pattern::kCosine);
  const double sharp = contrast(scenario, 0);
  scenario.sensor.defocus_px.knots = {{0.4, 0.0}, {0.5, 6.0}};
  EXPECT_EQ(contrast(scenario, 0), sharp);
  EXPECT_LT(contrast(scenario, 9), 0.6 * sharp);
}

// A movement of b px during the exposure multiplies the wave by sin(pi b / P) / (pi b / P). This is 0 at b = P and
// negative beyond.
TEST(MotionBlur, LowersTheContrastUpToAPitchAndInvertsItBeyond) {
  Scenario scenario = lines(Pattern::kLinesX);
  const double sharp = contrast(scenario);
  for (const double pitches : {0.5, 1.0, 1.4}) {
    const double speed = pitches * kPitch_mm / scenario.sensor.exposure_s;
    scenario.markers[0].dx.knots = {{-1.0, -speed}, {1.0, speed}};
    // A movement by more than a pitch removes the harmonics of binary lines. The first harmonic follows the sinc.
    const double expected = std::sin(kPi * pitches) / (kPi * pitches);
    EXPECT_NEAR(contrast(scenario) / sharp, expected, 0.03) << pitches << " pitches";
  }
}

TEST(Flicker, IsTheMeanOverTheExposure) {
  Scenario scenario = lines(Pattern::kLinesX);
  scenario.light.flicker = {.amplitude = 0.2, .frequency_hz = 100.0, .phase_deg = 0.0};
  const auto steady = lines(Pattern::kLinesX);
  const auto share = [&] { return render_ideal(scenario, 0).at(5, 5) / render_ideal(steady, 0).at(5, 5); };
  scenario.sensor.exposure_s = 0.01;
  EXPECT_NEAR(share(), 1.0, 1e-12) << "a whole period";
  scenario.light.flicker.phase_deg = 90.0;
  scenario.sensor.exposure_s = 0.005;
  EXPECT_NEAR(share(), 1.0 + 0.2 * 2.0 / kPi, 1e-12) << "half a period about its crest";
}

TEST(Flicker, VariesFromRowToRowWithARollingShutter) {
  Scenario scenario = lines(Pattern::kLinesX);
  scenario.sensor.exposure_s = 0.0;
  scenario.sensor.readout_s = 0.02;
  scenario.light.flicker = {.amplitude = 0.2, .frequency_hz = 50.0, .phase_deg = 0.0};
  const auto picture = render_ideal(scenario, 0);
  const int h = scenario.camera.height, y = h / 4;
  const double expected = 1.0 + 0.2 * std::sin(kTwoPi * ((y + 0.5) / h - 0.5));
  EXPECT_NEAR(picture.at(5, y) / 110.0, expected, 1e-12);
}

TEST(Glare, AddsAGaussianSpotAndMaySaturatePixels) {
  Scenario scenario = lines(Pattern::kLinesX);
  const auto without = render_ideal(scenario, 0);
  Glare& glare = scenario.markers[0].glare;
  glare.grey.offset = 180.0;
  glare.sigma_mm = 2.0;
  glare.x_mm.offset = 3.0;
  const auto with = render_ideal(scenario, 0);
  const ImagePoint p = project(scenario, 0, scenario.markers[0], {3.0, 0.0});
  const double sigma = std::hypot(2.0 * px_per_mm(scenario), scenario.sensor.psf_sigma_px);
  for (const int away : {0, 5, 11}) {
    const int x = static_cast<int>(p.x) + away, y = static_cast<int>(p.y);
    const double r2 = (x - p.x) * (x - p.x) + (y - p.y) * (y - p.y);
    EXPECT_NEAR(with.at(x, y) - without.at(x, y), 180.0 * std::exp(-0.5 * r2 / (sigma * sigma)), 1e-9);
  }
  EXPECT_EQ(render8(scenario, 0).at(static_cast<int>(p.x), static_cast<int>(p.y)), 255);
}

TEST(ToneCurve, IsAPowerOfTheLight) {
  Scenario scenario = lines(Pattern::kLinesX);
  scenario.sensor.noise_sigma = 0.0;
  scenario.sensor.gamma = 2.2;
  EXPECT_EQ(render8(scenario, 0).at(5, 5), std::lround(255.0 * std::pow(110.0 / 255.0, 1.0 / 2.2)));
}

TEST(RowNoise, IsCommonToARow) {
  Scenario scenario = lines(Pattern::kLinesX);
  scenario.sensor.noise_sigma = 0.0;
  scenario.sensor.row_noise = 4.0;
  double sum = 0.0;
  int rows = 0;
  for (long frame = 0; frame < 4; ++frame) {
    const auto picture = render8(scenario, frame);
    for (int y = 0; y < picture.height(); ++y, ++rows) {
      EXPECT_EQ(picture.at(3, y), picture.at(9, y)) << "background";
      sum += (picture.at(3, y) - 110.0) * (picture.at(3, y) - 110.0);
    }
  }
  EXPECT_NEAR(std::sqrt(sum / rows), 4.0, 4.0 * 4.0 / std::sqrt(2.0 * rows));
}

TEST(Zoom, ScalesTheImageAboutThePrincipalPoint) {
  Scenario scenario = lines(Pattern::kLinesX);
  scenario.optics.zoom.knots = {{0.0, 0.0}, {1.0, 0.01}};
  const ImagePoint c{scenario.camera.cx, scenario.camera.cy};
  const ImagePoint before = project(scenario, 0, {7.0, 4.0}), after = project(scenario, 10, {7.0, 4.0});
  EXPECT_NEAR(after.x - c.x, 1.01 * (before.x - c.x), 1e-9);
  EXPECT_NEAR(after.y - c.y, 1.01 * (before.y - c.y), 1e-9);
}

TEST(Stabiliser, MovesTheImage) {
  Scenario scenario = lines(Pattern::kLinesX);
  const auto before = render_ideal(scenario, 0);
  scenario.optics.shift_x.offset = 3.0;
  const auto after = render_ideal(scenario, 0);
  double worst = 0.0;
  for (int x = 10; x < before.width() - 10; ++x)
    worst = std::max(worst, std::abs(after.at(x + 3, 60) - before.at(x, 60)));
  EXPECT_LT(worst, 1e-6);
}

// A pitch of 2.2 px is close to the limit of 2 px. The remaining contrast is given by point spread and pixel area.
TEST(FinePitch, HasTheContrastThatPointSpreadAndPixelAreaTransfer) {
  Scenario scenario = lines(Pattern::kCosine);
  scenario.markers[0].print.grating->pitch_mm = 2.2 / px_per_mm(scenario);
  const auto picture = render_ideal(scenario, 0);
  double lightest = 0.0, darkest = 255.0;
  const ImagePoint middle = project(scenario, 0, scenario.markers[0], {0.0, 0.0});
  for (int x = static_cast<int>(middle.x) - 11; x <= static_cast<int>(middle.x) + 11; ++x) {
    lightest = std::max(lightest, picture.at(x, static_cast<int>(middle.y)));
    darkest = std::min(darkest, picture.at(x, static_cast<int>(middle.y)));
  }
  const double turn = kTwoPi / 2.2, psf = scenario.sensor.psf_sigma_px;
  const double passed = std::exp(-0.5 * turn * turn * psf * psf) * std::sin(0.5 * turn) / (0.5 * turn);
  // A wave with the full contrast of 170 grey levels has an amplitude of 85. A crossed cosine has half of it along each
  // axis. Pixels miss the crests by up to 0.1 px, a factor of cos(0.1 x 2 pi / 2.2) = 0.96.
  const double alone = 85.0 * passed;
  EXPECT_LT(0.5 * (lightest - darkest), 1.02 * alone);
  EXPECT_GT(0.5 * (lightest - darkest), 0.4 * alone);
}

}  // namespace
}  // namespace moiregauge::internal::simulator
