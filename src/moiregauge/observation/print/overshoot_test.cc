// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/overshoot.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/phase/fit/template_for_tests.h"

namespace moiregauge::internal {
namespace {

constexpr int kOrder = 9;
constexpr double kBlur = 0.04;  // pitches, sigma: 0.8 px of 20

double step(double x, double sigma) { return 0.5 * std::erfc(-x / (std::sqrt(2.0) * sigma)); }

// Returns the level of an edge that was blurred, and then sharpened by `amount` against a blur 1.6 times as wide.
double sharpened_step(double x, double amount) {
  return (1.0 + amount) * step(x, kBlur) - amount * step(x, 1.6 * kBlur);
}

// Returns light squares between dark lines, half a pitch wide.
PrintModel squares_of_light(double amount, double shift) {
  const auto profile = [&](double x) {
    return sharpened_step(std::abs(std::remainder(x - shift, 1.0)) - 0.25, amount);
  };
  PrintModel model;
  model.print = testing::template_of(kOrder, [&](double x, double y) { return 170.0 * profile(x) * profile(y); });
  return model;
}

double expected_overshoot(double amount) {
  double most = 0.0;
  for (double x = 0.0; x < 0.25; x += 0.001) most = std::max(most, sharpened_step(x, amount));
  return most * most - 1.0;  // at the corners of a square both profiles exceed the plateau
}

// Harmonics beyond the ninth are 1 % of the first at this blur.
TEST(Overshoot, IsWhatSharpeningAddsBeyondThePlateaus) {
  for (const double amount : {0.5, 1.0})
    EXPECT_NEAR(overshoot_of(squares_of_light(amount, 0.0)), expected_overshoot(amount), 0.02) << amount;
}

TEST(Overshoot, OfAPrintThatIsOnlyBlurredIsNone) { EXPECT_LT(overshoot_of(squares_of_light(0.0, 0.0)), 0.02); }

// The symmetry points of a checkerboard are centres of squares, of full contrast, and corners, of none. The template
// may begin at either.
TEST(Overshoot, OfACheckerboardIsThatOfItsSquares) {
  for (const double amount : {0.0, 0.5}) {
    double most = 0.0;
    for (double x = 0.0; x < 0.25; x += 0.001) most = std::max(most, sharpened_step(x, amount));
    for (const PrintPoint begin : {PrintPoint{0.0, 0.0}, PrintPoint{0.25, 0.25}, PrintPoint{0.13, 0.02}}) {
      const auto wave = [&](double x) {
        return 2.0 * sharpened_step(std::abs(std::remainder(x, 1.0)) - 0.25, amount) - 1.0;
      };
      PrintModel model;
      model.print = testing::template_of(
          kOrder, [&](double x, double y) { return 100.0 + 80.0 * wave(x + begin.x) * wave(y + begin.y); });
      const double seam = 2.0 * most - 1.0, expected = 0.5 * (seam * seam - 1.0);
      EXPECT_NEAR(overshoot_of(model), expected, 0.02) << amount << " from " << begin.x << ", " << begin.y;
    }
  }
}

TEST(Overshoot, IsTheSameWhereverTheTemplateHasItsOrigin) {
  EXPECT_NEAR(overshoot_of(squares_of_light(0.5, 0.13)), overshoot_of(squares_of_light(0.5, 0.0)), 0.01);
}

}  // namespace
}  // namespace moiregauge::internal
