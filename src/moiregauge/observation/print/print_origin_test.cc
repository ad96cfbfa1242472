// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/print_origin.h"

#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/phase/fit/template_for_tests.h"

namespace moiregauge::internal {
namespace {

constexpr double kOddHarmonics[] = {1.0, 3.0};

// Dark lines through the origin along both axes.
double dark_grid(double x, double y) {
  double value = 0.0;
  for (const double m : kOddHarmonics) value -= (std::cos(kTwoPi * m * x) + std::cos(kTwoPi * m * y)) / m;
  return 40.0 * (value + 0.3 * std::cos(kTwoPi * x) * std::cos(kTwoPi * y));
}
double checker_field(double x, double y) { return 60.0 * std::sin(kTwoPi * x) * std::sin(kTwoPi * y); }
double upright_lines(double x, double /*y*/) { return 60.0 * std::cos(kTwoPi * x); }
// Returns a saw: its second harmonic is a quarter of a period out of phase.
double saw_field(double x, double y) { return dark_grid(x, y) + 30.0 * std::sin(2.0 * kTwoPi * x); }

template <typename Level>
PrintTemplate shifted_print(const Level& level, double x, double y) {
  return testing::template_of(4, [&](double u, double v) { return level(u - x, v - y); });
}

TEST(PrintOrigin, IsWhereDarkLinesCross) {
  const auto origin = nearest_symmetry(shifted_print(dark_grid, 0.07, -0.11), true, true);
  ASSERT_TRUE(origin);
  EXPECT_NEAR(origin->at.x, 0.07, 1e-9);
  EXPECT_NEAR(origin->at.y, -0.11, 1e-9);
  EXPECT_NEAR(origin->spacing, std::sqrt(0.5), 1e-12);
  EXPECT_LT(origin->u, 1e-9);
}

TEST(PrintOrigin, IsTheNearestCornerOrCentreOfACheckerboard) {
  const auto corner = nearest_symmetry(shifted_print(checker_field, 0.03, 0.05), true, true);
  ASSERT_TRUE(corner);
  EXPECT_NEAR(corner->at.x, 0.03, 1e-9);
  EXPECT_NEAR(corner->at.y, 0.05, 1e-9);
}

TEST(PrintOrigin, OfLinesIsTheirMiddleAlongTheAxisThatTheyShow) {
  const auto origin = nearest_symmetry(shifted_print(upright_lines, 0.2, 0.3), true, false);
  ASSERT_TRUE(origin);
  EXPECT_NEAR(origin->at.x, 0.2, 1e-9);
  EXPECT_EQ(origin->at.y, 0.0);
}

TEST(PrintOrigin, APrintWithoutSymmetryHasNone) {
  EXPECT_FALSE(nearest_symmetry(shifted_print(saw_field, 0.0, 0.0), true, true));
}

TEST(PrintOrigin, MovingItMovesNothingOfThePrint) {
  const auto print = shifted_print(dark_grid, 0.0, 0.0);
  const PrintTemplate other(with_origin(print, {0.21, -0.37}));
  EXPECT_NEAR(other.at({0.1, 0.2}).t, print.at({0.31, -0.17}).t, 0.5);  // the table's error is 1e-2 of a harmonic
  EXPECT_NEAR(std::abs(other.coefficient(1, 1)), std::abs(print.coefficient(1, 1)), 1e-9);
}

}  // namespace
}  // namespace moiregauge::internal
