// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/print_model.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr int kSide = 130;  // px
constexpr double kPitchPx = 20.37;
constexpr double kPitches = 5.0;  // size of the grating
constexpr double kNoise = 1.5;    // grey levels
constexpr double kBlurPx = 0.76;  // sigma of lens and pixel

// Returns a view in which a millimetre is a pixel. y is up.
View upright() {
  Matrix3 h;
  h << 1, 0, 0.5 * kSide, 0, -1, 0.5 * kSide, 0, 0, 1;
  return {IdealFromBoard(h), {}};
}

Grating print() {
  return {
      .centre = {0.0, 0.0}, .width_mm = kPitches * kPitchPx, .height_mm = kPitches * kPitchPx, .pitch_mm = kPitchPx};
}

double step(double px) { return 0.5 * std::erfc(-px / (std::sqrt(2.0) * kBlurPx)); }
// Returns the level of lines half a pitch wide about 0, 1, ... pitches: 0 in a line, 1 between.
double lines(double px) { return step(std::abs(std::remainder(px, kPitchPx)) - 0.25 * kPitchPx); }
double crossed_lines(double x, double y) { return 40.0 + 170.0 * lines(x) * lines(y); }
double cosines(double x, double y) {
  return 125.0 + 42.5 * (std::cos(kTwoPi * x / kPitchPx) + std::cos(kTwoPi * y / kPitchPx));
}

template <typename Grey>
Image<std::uint8_t> seen(Grey grey, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> noise(0.0, kNoise);
  Image<std::uint8_t> picture(kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double px = x - 0.5 * kSide, py = 0.5 * kSide - y, half = 0.5 * kPitches * kPitchPx;
      const bool paper = std::abs(px) > half || std::abs(py) > half;
      picture.at(x, y) = static_cast<std::uint8_t>(std::lround((paper ? 210.0 : grey(px, py)) + noise(rng)));
    }
  }
  return picture;
}

PrintModel learned(const Image<std::uint8_t>& picture, TemplateUse use) {
  auto model = learn_print(picture.view(), upright(), print(), use);
  EXPECT_TRUE(model);
  return model.value();
}

// Shift of the whole grating along its x: the nine points relative to the map, weighted by their information.
struct Shift {
  double pitches = 0.0, u = 0.0;
};

Shift shift_of(const PatchFit& fit, const PrintFromImage& map) {
  Eigen::Matrix<double, 2 * kPatchPoints, 1> along = Eigen::Matrix<double, 2 * kPatchPoints, 1>::Zero(), off = along;
  for (int n = 0; n < kPatchPoints; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const auto d = fit.print[i] - map(fit.image[i]);
    along(n) = 1.0, off(n) = d.x, off(kPatchPoints + n) = d.y;
  }
  const double information = along.dot(fit.information * along);
  return {along.dot(fit.information * off) / information, 1.0 / std::sqrt(information)};
}

struct Scatter {
  double rms = 0.0, u = 0.0, pixels = 0.0;
};

constexpr int kPictures = 100;

Scatter scatter(const PrintModel& model) {
  const PrintFromImage map = model.correction * *local_map(upright(), print(), {});
  std::vector<double> shifts;
  Scatter s;
  double sum = 0.0;
  for (int k = 0; k < kPictures; ++k) {
    const auto picture = seen(crossed_lines, static_cast<std::uint64_t>(100 + k));
    const auto fit = read_points(picture.view(), upright(), print(), {}, model);
    EXPECT_TRUE(fit);
    const Shift shift = shift_of(*fit, map);
    shifts.push_back(shift.pitches);
    sum += shift.pitches;
    s.u = shift.u, s.pixels = fit->pixels;
  }
  for (const double x : shifts) s.rms += (x - sum / kPictures) * (x - sum / kPictures) / (kPictures - 1);
  s.rms = std::sqrt(s.rms);
  return s;
}

// The Fisher information of a shift is in the template's slopes at the window's pixels. The scatter of 100 images has u
// = 7 %. Light and the other columns of the field add a few per cent.
TEST(PrintModel, ATemplateLowersTheScatterByTheInformationOfTheEdges) {
  const auto first = seen(crossed_lines, 1);
  const PrintModel with = learned(first, TemplateUse::kOn), without = learned(first, TemplateUse::kOff);
  const Scatter on = scatter(with), off = scatter(without);
  const double sigma = std::hypot(kNoise, 1.0 / std::sqrt(12.0));
  const auto predicted = [&](const PrintModel& model, const Scatter& s) {
    return sigma / std::sqrt(model.print.slope_power_x() * s.pixels);
  };
  EXPECT_NEAR(on.rms / predicted(with, on), 1.0, 0.25);
  EXPECT_NEAR(off.rms / predicted(without, off), 1.0, 0.25);
  const double fewer = predicted(without, off) / predicted(with, on);
  EXPECT_GT(fewer, 1.5);
  EXPECT_NEAR(off.rms / on.rms / fewer, 1.0, 0.15);  // the same images, so most of the noise is common
  // With the template, u equals the scatter. Without it, the residual of the harmonics counts as noise.
  EXPECT_NEAR(on.u / on.rms, 1.0, 0.25);
  EXPECT_GT(off.u, 5.0 * off.rms);
}

TEST(PrintModel, HarmonicsAreUsedWhereTheyExist) {
  const auto binary = seen(crossed_lines, 1), cosine = seen(cosines, 1);
  EXPECT_EQ(learned(binary, TemplateUse::kAuto).print.order(), learned(binary, TemplateUse::kOn).print.order());
  EXPECT_EQ(learned(binary, TemplateUse::kOff).print.order(), 1);
  EXPECT_EQ(learned(cosine, TemplateUse::kAuto).print.order(), 1);
  EXPECT_GT(learned(cosine, TemplateUse::kOn).print.order(), 1);
}

// Over whole pitches harmonics are orthogonal to the fundamentals. A cosine has none, so its window keeps its size.
TEST(PrintModel, FundamentalsOfABinaryGratingAreReadOverWholePitches) {
  const PatchWindow binary = learned(seen(crossed_lines, 1), TemplateUse::kOff).window;
  EXPECT_DOUBLE_EQ(2.0 * binary.half_x, std::round(2.0 * binary.half_x));
  EXPECT_DOUBLE_EQ(2.0 * binary.half_y, std::round(2.0 * binary.half_y));
  const auto cosine = seen(cosines, 1);
  EXPECT_EQ(learned(cosine, TemplateUse::kOff).window.half_x, learned(cosine, TemplateUse::kOn).window.half_x);
}

}  // namespace
}  // namespace moiregauge::internal
