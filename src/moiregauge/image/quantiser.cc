// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/image/quantiser.h"

#include <algorithm>
#include <array>

namespace moiregauge::internal {
namespace {

constexpr double kQuartile = 0.75;  // quantile of the blocks under a rectangle; see QuantiserMap::within
constexpr std::size_t kFirstEntry = 1, kLastEntry = 20;

int block_at(double px, int blocks) {
  return static_cast<int>(std::clamp(std::floor(px / kQuantiserBlock), 0.0, static_cast<double>(blocks - 1)));
}

}  // namespace

std::uint8_t parameter_of_step(double step) {
  if (!(step > 0.0)) return 0;
  return static_cast<std::uint8_t>(std::clamp(std::lround(6.0 * std::log2(step / 0.625)), 0L, long{kMaxParameter}));
}

Quantiser QuantiserMap::within(double x0, double y0, double x1, double y1) const {
  if (blocks.height <= 0 || blocks.width <= 0 || !(whole.step > 0.0) || !(x0 <= x1) || !(y0 <= y1)) return whole;
  std::array<long, 256> counts{};
  long total = 0;
  for (int y = block_at(y0, blocks.height); y <= block_at(y1, blocks.height); ++y) {
    for (int x = block_at(x0, blocks.width); x <= block_at(x1, blocks.width); ++x, ++total)
      ++counts[std::min<std::size_t>(blocks.row(y)[static_cast<std::size_t>(x)], kMaxParameter)];
  }
  long below = 0;
  int parameter = 0;
  while (below += counts[static_cast<std::size_t>(parameter)],
         static_cast<double>(below) < kQuartile * static_cast<double>(total))
    ++parameter;
  return {step_of_parameter(parameter), whole.predicted};
}

double step_of_jpeg_table(std::span<const std::uint16_t, 64> zigzag) {
  double sum = 0.0;
  for (std::size_t k = kFirstEntry; k <= kLastEntry; ++k) sum += std::pow(static_cast<double>(zigzag[k]), 2);
  return std::sqrt(sum / static_cast<double>(kLastEntry - kFirstEntry + 1));
}

}  // namespace moiregauge::internal
