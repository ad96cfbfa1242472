// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/print_template.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "moiregauge/units/units.h"

namespace moiregauge {
namespace {

using Complex = std::complex<double>;

// Table points per period of the highest harmonic.
constexpr int kPointsPerPeriod = 16;
constexpr int kLeastSide = 64;

std::size_t index_of(int order, int m, int n) {
  return static_cast<std::size_t>((n + order) * (2 * order + 1) + m + order);
}

// exp(2 pi i k / side), k = 0 .. side - 1.
std::vector<Complex> turns(int side) {
  std::vector<Complex> out;
  for (int k = 0; k < side; ++k) out.push_back(std::polar(1.0, kTurn * k / side));
  return out;
}

// Weights of the four neighbours at t in [0, 1), and their derivatives by t (cubic convolution, a = -1/2).
struct Weights {
  std::array<double, 4> w, d;
  explicit Weights(double t)
      : w{((-0.5 * t + 1.0) * t - 0.5) * t, (1.5 * t - 2.5) * t * t + 1.0, ((-1.5 * t + 2.0) * t + 0.5) * t,
          (0.5 * t - 0.5) * t * t},
        d{(-1.5 * t + 2.0) * t - 0.5, (4.5 * t - 5.0) * t, (-4.5 * t + 4.0) * t + 0.5, (1.5 * t - 1.0) * t} {}
};

// The series on the grid: its rows summed over m for every column, then over n for every row.
std::vector<float> tabulated(const std::vector<Complex>& series, int order, int side) {
  const auto turn = turns(side);
  const auto at = [&](int k, int step) { return turn[static_cast<std::size_t>(((k * step) % side + side) % side)]; };
  std::vector<Complex> partial(static_cast<std::size_t>((2 * order + 1) * side));
  for (int n = -order; n <= order; ++n) {
    for (int i = 0; i < side; ++i) {
      Complex sum = 0.0;
      for (int m = -order; m <= order; ++m) sum += series[index_of(order, m, n)] * at(m, i);
      partial[static_cast<std::size_t>((n + order) * side + i)] = sum;
    }
  }
  const int wide = side + 3;
  std::vector<float> table(static_cast<std::size_t>(wide * wide));
  for (int j = 0; j < wide; ++j) {
    for (int i = 0; i < wide; ++i) {
      const int column = (i - 1 + side) % side;
      Complex sum = 0.0;
      for (int n = -order; n <= order; ++n)
        sum += partial[static_cast<std::size_t>((n + order) * side + column)] * at(n, j - 1);
      table[static_cast<std::size_t>(j * wide + i)] = static_cast<float>(sum.real());
    }
  }
  return table;
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
  side_ = std::max(kLeastSide, kPointsPerPeriod * order);
  const auto bent = [&](bool along_x) {
    std::vector<Complex> second = series_;
    for (int n = -order; n <= order; ++n) {
      for (int m = -order; m <= order; ++m) second[index_of(order, m, n)] *= -kTurn * kTurn * (along_x ? m * m : n * n);
    }
    return second;
  };
  table_ = tabulated(series_, order, side_);
  table_xx_ = tabulated(bent(true), order, side_);
  table_yy_ = tabulated(bent(false), order, side_);
}

PrintTemplate PrintTemplate::cosine(double amplitude_x, double amplitude_y) {
  std::array<Complex, 9> series{};
  series[index_of(1, 1, 0)] = series[index_of(1, -1, 0)] = 0.5 * amplitude_x;
  series[index_of(1, 0, 1)] = series[index_of(1, 0, -1)] = 0.5 * amplitude_y;
  return {1, series};
}

PrintLevel PrintTemplate::at(PrintPoint p) const {
  const double u = (p.x - std::floor(p.x)) * side_, v = (p.y - std::floor(p.y)) * side_;
  const int i = std::min(static_cast<int>(u), side_ - 1), j = std::min(static_cast<int>(v), side_ - 1);
  const Weights across(u - i), up(v - j);
  const int wide = side_ + 3;
  PrintLevel level;
  for (int row = 0; row < 4; ++row) {
    const int first = (j + row) * wide + i;
    double value = 0.0, slope = 0.0, xx = 0.0, yy = 0.0;
    for (int column = 0; column < 4; ++column) {
      const auto k = static_cast<std::size_t>(column), at = static_cast<std::size_t>(first + column);
      value += across.w[k] * static_cast<double>(table_[at]);
      slope += across.d[k] * static_cast<double>(table_[at]);
      xx += across.w[k] * static_cast<double>(table_xx_[at]);
      yy += across.w[k] * static_cast<double>(table_yy_[at]);
    }
    const auto k = static_cast<std::size_t>(row);
    level.t += up.w[k] * value;
    level.dx += up.w[k] * slope;
    level.dy += up.d[k] * value;
    level.dxx += up.w[k] * xx;
    level.dyy += up.w[k] * yy;
  }
  level.dx *= side_;
  level.dy *= side_;
  return level;
}

Complex PrintTemplate::coefficient(int m, int n) const {
  if (std::abs(m) > order_ || std::abs(n) > order_) return 0.0;
  return series_[index_of(order_, m, n)];
}

double PrintTemplate::contrast() const {
  double sum = 0.0;
  for (const Complex& c : series_) sum += std::norm(c);
  return std::sqrt(sum);
}

double PrintTemplate::slope_power_x() const {
  double sum = 0.0;
  for (int n = -order_; n <= order_; ++n) {
    for (int m = -order_; m <= order_; ++m) sum += m * m * std::norm(series_[index_of(order_, m, n)]);
  }
  return kTurn * kTurn * sum;
}

double PrintTemplate::slope_power_y() const {
  double sum = 0.0;
  for (int n = -order_; n <= order_; ++n) {
    for (int m = -order_; m <= order_; ++m) sum += n * n * std::norm(series_[index_of(order_, m, n)]);
  }
  return kTurn * kTurn * sum;
}

int highest_order(double pitch_px) { return std::max(1, static_cast<int>(std::floor(pitch_px / 2.2))); }

}  // namespace moiregauge
