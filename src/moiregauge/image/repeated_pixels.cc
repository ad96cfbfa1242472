// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/image/repeated_pixels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace moiregauge::internal {
namespace {

constexpr double kSameStep = 0.125;  // largest difference within a step, relative to the least jump; chosen

// `at(i)`: the i-th grey level of a line.
template <typename At>
void count_line(int length, double least_jump, At at, SlopeSteps& steps) {
  double jump_before = 0.0;  // onto the current step; 0: unknown
  int width = 1;
  for (int i = 1; i < length; ++i) {
    const double jump = at(i) - at(i - 1);
    if (std::abs(jump) < kSameStep * least_jump) {
      ++width;
      continue;
    }
    const bool is_jump = std::abs(jump) >= least_jump;
    if (is_jump && jump * jump_before > 0.0) {
      ++steps.all;
      steps.repeated += width > 1;
    }
    jump_before = is_jump ? jump : 0.0;
    width = 1;
  }
}

}  // namespace

SlopeSteps count_slope_steps(const LumaView& part, double least_jump) {
  SlopeSteps steps;
  std::visit(
      [&](const auto& picture) {
        for (int y = 0; y < picture.height; ++y)
          count_line(
              picture.width, least_jump, [&](int x) { return static_cast<double>(picture.at(x, y)); }, steps);
        for (int x = 0; x < picture.width; ++x)
          count_line(
              picture.height, least_jump, [&](int y) { return static_cast<double>(picture.at(x, y)); }, steps);
      },
      part);
  return steps;
}

}  // namespace moiregauge::internal
