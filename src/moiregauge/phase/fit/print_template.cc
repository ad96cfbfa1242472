// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/fit/print_template.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Core>

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

// Harmonics along x at the columns of nodes, summed over m, for each n from 0 on: side x (order + 1).
struct Columns {
  Eigen::ArrayXXd re, im;
};

// Cosine and sine of 2 pi k / side, for k = 0 to side - 1.
struct Turns {
  Eigen::ArrayXd c, s;
  explicit Turns(int side) : c(side), s(side) {
    for (int k = 0; k < side; ++k) {
      const Complex turn = std::polar(1.0, kTwoPi * k / side);
      c(k) = turn.real(), s(k) = turn.imag();
    }
  }
  // Returns both at every multiple of `step`.
  Turns(const Turns& from, int step) : c(from.c.size()), s(from.c.size()) {
    const auto side = static_cast<int>(c.size());
    for (int i = 0, at = 0; i < side; ++i, at = at + step < side ? at + step : at + step - side)
      c(i) = from.c(at), s(i) = from.s(at);
  }
};

// Returns the p-th Taylor coefficient along x: each harmonic times (2 pi i m / side)^p / p!. The series is real, so
// orders n and -n contribute the same.
Columns summed_along_x(const std::vector<Complex>& series, int order, const Turns& turns, int p) {
  const auto side = turns.c.size();
  const double step = kTwoPi / static_cast<double>(side);
  Columns out{Eigen::ArrayXXd::Zero(side, order + 1), Eigen::ArrayXXd::Zero(side, order + 1)};
  for (int m = -order; m <= order; ++m) {
    const Turns turn(turns, (m + static_cast<int>(side)) % static_cast<int>(side));
    Complex factor = 1.0;
    for (int k = 1; k <= p; ++k) factor *= Complex(0.0, step * m / k);
    for (int n = 0; n <= order; ++n) {
      const Complex c = (n == 0 ? 1.0 : 2.0) * factor * series[index_of(order, m, n)];
      out.re.col(n) += c.real() * turn.c - c.imag() * turn.s;
      out.im.col(n) += c.real() * turn.s + c.imag() * turn.c;
    }
  }
  return out;
}

// Returns the table of a Taylor coefficient of order q along y, from its sums along x. A row and the one as far below
// zero as it is above have the same even and the opposite odd part.
Eigen::ArrayXXd tabulated(const Columns& columns, const Turns& turns, int q) {
  const auto side = static_cast<int>(turns.c.size());
  Eigen::ArrayXXd table(side, side);
  Eigen::ArrayXd even(side), odd(side);
  for (int j = 0; 2 * j <= side; ++j) {
    even.setZero(), odd.setZero();
    for (int n = 0; n < columns.re.cols(); ++n) {
      const double step = kTwoPi * n / side, factor = q == 0 ? 1.0 : q == 1 ? step : -0.5 * step * step;
      const double c = factor * turns.c((n * j) % side), s = factor * turns.s((n * j) % side);
      // The first derivative multiplies by i, which exchanges real and imaginary part.
      if (q == 1) {
        even -= columns.im.col(n) * c;
        odd -= columns.re.col(n) * s;
      } else {
        even += columns.re.col(n) * c;
        odd -= columns.im.col(n) * s;
      }
    }
    table.col(j) = even + odd;
    table.col((side - j) % side) = even - odd;
    if (j == 0) table.col(0) = even;
  }
  return table;
}

// Returns the nearest whole number, halves away from zero, as std::lround does. This one needs no call.
std::int32_t nearest_whole(double value) {
  const auto whole = static_cast<std::int32_t>(value);
  const double rest = value - whole;
  return whole + (rest >= 0.5 ? 1 : rest <= -0.5 ? -1 : 0);
}

// Puts a table into the words of the nodes as coefficient k.
void put(const Eigen::ArrayXXd& table, std::size_t k, PrintNodes& nodes) {
  const int side = nodes.side, wide = nodes.wide();
  const double most = std::max(1e-30, table.abs().maxCoeff());
  nodes.scale[k] = static_cast<float>(most / kFullScale);
  const Eigen::ArrayXXd scaled = table / most * kFullScale;
  const auto inside = [side](int i) { return i == 0 ? side - 1 : i > side ? i - side - 1 : i - 1; };
  for (int j = 0; j < wide; ++j) {
    const double* const row = scaled.col(inside(j)).data();
    std::int32_t* to = nodes.words.data() + static_cast<std::ptrdiff_t>(j) * wide * PrintNodes::kStride +
                       static_cast<std::ptrdiff_t>(k / 2);
    for (int i = 0; i < wide; ++i, to += PrintNodes::kStride) {
      const std::int32_t whole = nearest_whole(row[inside(i)]);
      *to |= static_cast<std::int32_t>(static_cast<std::uint32_t>(whole & 0xffff) << (k % 2 == 0 ? 0 : 16));
    }
  }
}

PrintNodes nodes_of(const std::vector<Complex>& series, int order) {
  PrintNodes nodes;
  nodes.side = std::max(kMinSide, kNodesPerPeriod * order);
  nodes.words.assign(static_cast<std::size_t>(nodes.wide() * nodes.wide() * PrintNodes::kStride), 0);
  const Turns turns(nodes.side);
  for (int p = 0; p <= 2; ++p) {
    const Columns columns = summed_along_x(series, order, turns, p);
    for (std::size_t k = 0; k < kNodePowers.size(); ++k) {
      if (kNodePowers[k].x == p) put(tabulated(columns, turns, kNodePowers[k].y), k, nodes);
    }
  }
  return nodes;
}

}  // namespace

PrintSeries::PrintSeries(int order, std::span<const Complex> series) : order_(order), series_(series.size()) {
  for (int n = -order; n <= order; ++n) {
    for (int m = -order; m <= order; ++m) {
      series_[index_of(order, m, n)] =
          0.5 * (series[index_of(order, m, n)] + std::conj(series[index_of(order, -m, -n)]));
    }
  }
  series_[index_of(order, 0, 0)] = 0.0;
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

PrintTemplate::PrintTemplate(PrintSeries series)
    : PrintSeries(std::move(series)), nodes_(nodes_of(PrintSeries::series(), order())) {}

PrintTemplate::PrintTemplate(int order, std::span<const Complex> series) : PrintTemplate(PrintSeries(order, series)) {}

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

Complex PrintSeries::coefficient(int m, int n) const {
  if (std::abs(m) > order_ || std::abs(n) > order_) return 0.0;
  return series_[index_of(order_, m, n)];
}

PrintSeries averaged_along_lines(const PrintSeries& print, bool changes_along_x) {
  std::vector<Complex> series;
  for (int n = -print.order(); n <= print.order(); ++n) {
    for (int m = -print.order(); m <= print.order(); ++m)
      series.push_back((changes_along_x ? n : m) == 0 ? print.coefficient(m, n) : 0.0);
  }
  return {print.order(), series};
}

int highest_order(double pitch_px) { return std::max(1, static_cast<int>(std::floor(pitch_px / 2.2))); }

}  // namespace moiregauge::internal
