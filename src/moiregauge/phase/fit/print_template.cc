// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/fit/print_template.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using Complex = std::complex<double>;

// Nodes per period of the highest harmonic. Half a step is 0.39 rad, so the third term of the Taylor series is 1e-2.
constexpr int kNodesPerPeriod = 8;
// Fewest nodes per pitch. Chosen.
constexpr int kMinSide = 64;
// Largest coefficient of 16 bits.
constexpr double kFullScale = 32767.0;

std::size_t index_of(int order, int m, int n) {
  return static_cast<std::size_t>((n + order) * (2 * order + 1) + m + order);
}

// Returns exp(2 pi i k / side) for k = 0 to side - 1.
std::vector<Complex> turns(int side) {
  std::vector<Complex> out;
  for (int k = 0; k < side; ++k) out.push_back(std::polar(1.0, kTwoPi * k / side));
  return out;
}

// Returns the series on the grid: summed over m for every column, then over n for every row. The series is real, so
// rows n and -n contribute the same.
std::vector<double> tabulated(const std::vector<Complex>& series, int order, int side) {
  const auto turn = turns(side);
  const auto points = static_cast<std::size_t>(side);
  std::vector<double> re((static_cast<std::size_t>(order) + 1) * points), im(re.size());
  for (int n = 0; n <= order; ++n) {
    for (int i = 0; i < side; ++i) {
      Complex sum = 0.0;
      int at = (order * (side - i)) % side;  // -order * i, increased by i with every m
      for (int m = -order; m <= order; ++m) {
        sum += series[index_of(order, m, n)] * turn[static_cast<std::size_t>(at)];
        at = at + i < side ? at + i : at + i - side;
      }
      const std::size_t k = static_cast<std::size_t>(n) * points + static_cast<std::size_t>(i);
      re[k] = n == 0 ? sum.real() : 2.0 * sum.real();
      im[k] = n == 0 ? sum.imag() : 2.0 * sum.imag();
    }
  }
  std::vector<double> table(points * points);
  for (int j = 0; j < side; ++j) {
    double* const row = table.data() + static_cast<std::size_t>(j) * points;
    for (int n = 0; n <= order; ++n) {
      const Complex t = turn[static_cast<std::size_t>((n * j) % side)];
      const double *const a = re.data() + static_cast<std::size_t>(n) * points, *const b = im.data() +
                                                                                           static_cast<std::size_t>(n) *
                                                                                               points;
      for (std::size_t i = 0; i < points; ++i) row[i] += a[i] * t.real() - b[i] * t.imag();
    }
  }
  return table;
}

// Returns the series of a Taylor coefficient per node: each harmonic times (2 pi i m)^p / p! (2 pi i n)^q / q!.
std::vector<Complex> derived(const std::vector<Complex>& series, int order, int side, NodePower power) {
  std::vector<Complex> out = series;
  const double step = kTwoPi / side;
  for (int n = -order; n <= order; ++n) {
    for (int m = -order; m <= order; ++m) {
      Complex& c = out[index_of(order, m, n)];
      for (int k = 1; k <= power.x; ++k) c *= Complex(0.0, step * m / k);
      for (int k = 1; k <= power.y; ++k) c *= Complex(0.0, step * n / k);
    }
  }
  return out;
}

PrintNodes nodes_of(const std::vector<Complex>& series, int order) {
  PrintNodes nodes;
  nodes.side = std::max(kMinSide, kNodesPerPeriod * order);
  const int side = nodes.side, wide = nodes.wide();
  nodes.words.assign(static_cast<std::size_t>(wide * wide * PrintNodes::kStride), 0);
  for (std::size_t k = 0; k < kNodePowers.size(); ++k) {
    const auto table = tabulated(derived(series, order, side, kNodePowers[k]), order, side);
    double most = 1e-30;
    for (const double value : table) most = std::max(most, std::abs(value));
    nodes.scale[k] = static_cast<float>(most / kFullScale);
    for (int j = 0; j < wide; ++j) {
      for (int i = 0; i < wide; ++i) {
        const int from = ((j - 1 + side) % side) * side + (i - 1 + side) % side;
        const auto whole =
            static_cast<std::int32_t>(std::lround(table[static_cast<std::size_t>(from)] / most * kFullScale));
        auto& word = nodes.words[static_cast<std::size_t>((j * wide + i) * PrintNodes::kStride) + k / 2];
        word |= static_cast<std::int32_t>(static_cast<std::uint32_t>(whole & 0xffff) << (k % 2 == 0 ? 0 : 16));
      }
    }
  }
  return nodes;
}

}  // namespace

PrintTemplate::PrintTemplate(int order, std::span<const Complex> series) : order_(order), series_(series.size()) {
  for (int n = -order; n <= order; ++n) {
    for (int m = -order; m <= order; ++m) {
      series_[index_of(order, m, n)] =
          0.5 * (series[index_of(order, m, n)] + std::conj(series[index_of(order, -m, -n)]));
    }
  }
  series_[index_of(order, 0, 0)] = 0.0;
  nodes_ = nodes_of(series_, order);
  double power = 0.0;
  for (int n = -order; n <= order; ++n) {
    for (int m = -order; m <= order; ++m) {
      const double here = std::norm(series_[index_of(order, m, n)]);
      power += here;
      slope_power_[0] += kTwoPi * kTwoPi * m * m * here, slope_power_[1] += kTwoPi * kTwoPi * n * n * here;
    }
  }
  contrast_ = std::sqrt(power);
}

PrintTemplate PrintTemplate::cosine(double amplitude_x, double amplitude_y) {
  std::array<Complex, 9> series{};
  series[index_of(1, 1, 0)] = series[index_of(1, -1, 0)] = 0.5 * amplitude_x;
  series[index_of(1, 0, 1)] = series[index_of(1, 0, -1)] = 0.5 * amplitude_y;
  return {1, series};
}

PrintLevel PrintTemplate::at(PrintPoint p) const {
  const double side = nodes_.side;
  const double x = (p.x - std::floor(p.x)) * side, y = (p.y - std::floor(p.y)) * side;
  const double i = std::round(x), j = std::round(y), u = x - i, v = y - j;
  const auto node = static_cast<std::size_t>((static_cast<int>(j) + 1) * nodes_.wide() + static_cast<int>(i) + 1);
  std::array<double, kNodePowers.size()> a{};
  for (std::size_t k = 0; k < a.size(); ++k) {
    const std::int32_t word = nodes_.words[node * PrintNodes::kStride + k / 2];
    a[k] = static_cast<double>(static_cast<std::int16_t>(k % 2 == 0 ? word & 0xffff : word >> 16)) *
           static_cast<double>(nodes_.scale[k]);
  }
  PrintLevel level;
  level.t = a[0] + u * (a[1] + u * a[3] + v * a[4]) + v * (a[2] + v * a[5]);
  level.dx = side * (a[1] + 2.0 * u * a[3] + v * a[4]);
  level.dy = side * (a[2] + 2.0 * v * a[5] + u * a[4]);
  level.dxx = side * side * 2.0 * a[3];
  level.dyy = side * side * 2.0 * a[5];
  return level;
}

Complex PrintTemplate::coefficient(int m, int n) const {
  if (std::abs(m) > order_ || std::abs(n) > order_) return 0.0;
  return series_[index_of(order_, m, n)];
}

int highest_order(double pitch_px) { return std::max(1, static_cast<int>(std::floor(pitch_px / 2.2))); }

}  // namespace moiregauge::internal
