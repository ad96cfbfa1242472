// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/figures/figure_rotation.h"

#include <cmath>

#include <gtest/gtest.h>

namespace moiregauge::internal::figure {
namespace {

RotationFigure of_points(std::vector<RotationPoint> points) {
  return {.lenses = {{"no distortion", {{"two-stage", std::move(points)}}}},
          .published = {{Turn::kOneAxis, 0.1, 0.02}, {Turn::kAllAxes, 8.0, 1.861}}};
}

std::string png_of(const RotationFigure& f) { return files_of(error_against_rotation(f)).png; }

TEST(ErrorAgainstRotation, ARunWithoutValuesHasNoMark) {
  const double none = std::nan("");
  EXPECT_EQ(png_of(of_points({{Turn::kAllAxes, 8.0, none, none, true}})), png_of(of_points({})));
}

TEST(ErrorAgainstRotation, LostFramesAreMarked) {
  EXPECT_NE(png_of(of_points({{Turn::kAllAxes, 8.0, 0.5, 0.3, true}})),
            png_of(of_points({{Turn::kAllAxes, 8.0, 0.5, 0.3, false}})));
}

}  // namespace
}  // namespace moiregauge::internal::figure
