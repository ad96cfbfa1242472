// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/gratings/grating_fit.h"

#include <gtest/gtest.h>

#include "moiregauge/detection/gratings/painted_print_for_tests.h"

namespace moiregauge::internal {
namespace {

Image<float> floats(const Image<std::uint8_t>& from) {
  Image<float> out(from.width(), from.height());
  for (int y = 0; y < out.height(); ++y) std::copy(from.row(y).begin(), from.row(y).end(), out.row(y).begin());
  return out;
}

// Returns a start for the fit: the lattice of the grating with a pitch error of 2 %.
LatticeModel begun(const testing::PaintedPrint& print) {
  LatticeModel model;
  model.lattice.origin = print.centre;
  model.lattice.k = 1.02 * print.k;
  return model;
}

// Relative, 4 sigma. The noise is 1.5 grey levels, the amplitude a = 34, the area n = 61 x 61 px. A phase then has
// u = sqrt(2 / n) 1.5 / a rad. A slope over three periods has sqrt(12) / (3 * 2 pi) of that. The Hann weight makes it
// 1.9 times larger: 4e-4 of the pitch.
constexpr double kPitchTolerance = 1.6e-3;

TEST(LatticeFit, ThePitchOfThreePeriodsReachesTheBoundOfTheNoise) {
  testing::PaintedPrint print;
  print.k = testing::lattice(20.3, 0.2);
  print.half_x = print.half_y = 1.5;
  print.ink = testing::ink_of_squares;
  auto picture = testing::blank(200, 200);
  testing::paint(print, picture);
  testing::expose(picture, 1.5);
  LatticeModel model = begun(print);
  ASSERT_TRUE(
      fit_lattice(floats(picture), {{-1.5, -1.5}, {1.5, 1.5}}, Eigen::Matrix2d::Identity(), {3, false, 20000}, model));
  EXPECT_LT((model.lattice.k - print.k).norm() / print.k.norm(), kPitchTolerance);
  EXPECT_GT(model.explained(), 0.9);
}

// Uses all pixels: with stratified points the fourth and higher harmonics would act as noise, 4e-4 of the pitch here.
TEST(LatticeFit, ThePerspectiveOfAGratingIsFitted) {
  testing::PaintedPrint print;
  print.centre = {110, 110};
  print.k = testing::lattice(20.3, -0.1);
  print.q = {2e-4, -3e-4};
  print.half_x = print.half_y = 4.5;
  print.ink = testing::ink_of_squares;
  auto picture = testing::blank(220, 220);
  testing::paint(print, picture);
  LatticeModel model = begun(print);
  model.lattice.k = 1.002 * print.k;
  ASSERT_TRUE(
      fit_lattice(floats(picture), {{-4.5, -4.5}, {4.5, 4.5}}, Eigen::Matrix2d::Identity(), {3, true, 100000}, model));
  EXPECT_LT((model.lattice.q - print.q).norm(), 0.02 * print.q.norm());
  EXPECT_LT((model.lattice.k - print.k).norm() / print.k.norm(), 2e-4);
  const Eigen::Vector2d s(4.0, -3.0);
  EXPECT_LT((model.lattice.phi(model.lattice.at(s)) - s).norm(), 1e-9);  // round trip
}

TEST(LatticeFit, ASlopeOfLightIsNoPartOfTheGrating) {
  testing::PaintedPrint print;
  print.k = testing::lattice(20.0, 0.0);
  print.half_x = print.half_y = 4.0;
  print.ink = testing::ink_of_squares;
  auto picture = testing::blank(200, 200);
  testing::paint(print, picture);
  testing::expose(picture, 0.0, 0.5);
  LatticeModel model = begun(print);
  model.lattice.k = print.k;
  ASSERT_TRUE(fit_lattice(floats(picture), {{-3, -3}, {3, 3}}, Eigen::Matrix2d::Identity(), {3, true, 20000}, model));
  EXPECT_NEAR(model.slope.x(), -0.5 * 167.5 / 200, 0.05);  // the mean level of squares on paper is 167.5
  EXPECT_LT((model.lattice.k - print.k).norm() / print.k.norm(), 1e-3);
}

}  // namespace
}  // namespace moiregauge::internal
