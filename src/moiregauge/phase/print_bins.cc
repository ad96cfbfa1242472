// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/print_bins.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "moiregauge/units/units.h"

namespace moiregauge {
namespace {

using Complex = std::complex<double>;

// Bins per period of the highest harmonic. A pixel is shared among the four bins round it, which acts on a harmonic of
// k periods as sinc^2(k / side), taken out again, and folds (k / side)^2 of others into it: 0.4 % at worst.
constexpr int kBinsPerPeriod = 32;
constexpr int kLeastBins = 64;
// Relative to the mean weight: enough to keep a series that the bins leave open from running away, 1e-6 of what they
// say.
constexpr double kRidge = 1e-6;
constexpr long kLeastPixelsPerUnknown = 4;

double sinc(double x) { return x == 0.0 ? 1.0 : std::sin(kPi * x) / (kPi * x); }

// sum over pixels of value exp(-2 pi i (m X + n Y)) for |m|, |n| <= highest, from what they left in the bins; n
// slowest. Values are real: one half is the other's conjugate.
std::vector<Complex> spectrum(const std::vector<double>& value, int side, int highest) {
  const int wide = 2 * highest + 1;
  std::vector<double> c, s;  // of the turns
  for (int k = 0; k < side; ++k) c.push_back(std::cos(kTurn * k / side)), s.push_back(-std::sin(kTurn * k / side));
  std::vector<Complex> rows(static_cast<std::size_t>(side * (highest + 1))), out(static_cast<std::size_t>(wide * wide));
  for (int j = 0; j < side; ++j) {
    const double* from = value.data() + static_cast<std::ptrdiff_t>(j) * side;
    for (int m = 0; m <= highest; ++m) {
      double re = 0.0, im = 0.0;
      for (int i = 0, k = 0; i < side; ++i, k += m) {
        if (k >= side) k -= side;
        re += from[i] * c[static_cast<std::size_t>(k)];
        im += from[i] * s[static_cast<std::size_t>(k)];
      }
      rows[static_cast<std::size_t>(j * (highest + 1) + m)] = {re, im};
    }
  }
  for (int n = -highest; n <= highest; ++n) {
    for (int m = 0; m <= highest; ++m) {
      Complex sum = 0.0;
      for (int j = 0, k = 0, step = n < 0 ? n + side : n; j < side; ++j, k += step) {
        if (k >= side) k -= side;
        sum += rows[static_cast<std::size_t>(j * (highest + 1) + m)] *
               Complex(c[static_cast<std::size_t>(k)], s[static_cast<std::size_t>(k)]);
      }
      const double shared = sinc(double(m) / side) * sinc(double(n) / side);
      sum /= shared * shared;
      out[static_cast<std::size_t>((n + highest) * wide + m + highest)] = sum;
      out[static_cast<std::size_t>((highest - n) * wide + highest - m)] = std::conj(sum);
    }
  }
  return out;
}

}  // namespace

PrintBins::PrintBins(int order)
    : order_(order),
      side_(std::max(kLeastBins, kBinsPerPeriod * order)),
      count_(static_cast<std::size_t>(side_ * side_)),
      sum_(static_cast<std::size_t>(side_ * side_)) {}

void PrintBins::add(PrintPoint p, double grey) {
  const double x = (p.x - std::floor(p.x)) * side_, y = (p.y - std::floor(p.y)) * side_;
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  for (const auto& [row, down] : {std::pair{j, 1.0 - (y - j)}, {j + 1, y - j}}) {
    for (const auto& [column, across] : {std::pair{i, 1.0 - (x - i)}, {i + 1, x - i}}) {
      const auto bin = static_cast<std::size_t>((row % side_) * side_ + column % side_);
      count_[bin] += down * across;
      sum_[bin] += down * across * grey;
    }
  }
  ++pixels_;
}

std::optional<PrintTemplate> PrintBins::fit() const {
  const int wide = 2 * order_ + 1, half = (wide * wide - 1) / 2, unknowns = 2 * half + 1;
  if (pixels_ < kLeastPixelsPerUnknown * unknowns) return std::nullopt;
  // The series is real: one half of its exponentials, as cosines and sines, beside the mean. Products of two of them
  // are cosines and sines of sums and differences, so two spectra hold the whole of the normal equations.
  const auto weight = spectrum(count_, side_, 2 * order_);
  const auto right = spectrum(sum_, side_, order_);
  const int far = 4 * order_ + 1;
  const auto w = [&](int m, int n) {
    return weight[static_cast<std::size_t>((n + 2 * order_) * far + m + 2 * order_)];
  };
  std::vector<std::pair<int, int>> orders;  // m, n of the half that comes after (0, 0)
  for (int k = half + 1; k < wide * wide; ++k) orders.emplace_back(k % wide - order_, k / wide - order_);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);  // mean, cosines, sines; lower half
  Eigen::VectorXd r(unknowns);
  normal(0, 0) = w(0, 0).real();
  r(0) = right[static_cast<std::size_t>(half)].real();
  for (int a = 0; a < half; ++a) {
    const auto [ma, na] = orders[static_cast<std::size_t>(a)];
    const Complex own = w(ma, na), rhs = right[static_cast<std::size_t>(half + 1 + a)];
    normal(1 + a, 0) = own.real();
    normal(1 + half + a, 0) = -own.imag();
    r(1 + a) = rhs.real();
    r(1 + half + a) = -rhs.imag();
    for (int b = 0; b < half; ++b) {
      const auto [mb, nb] = orders[static_cast<std::size_t>(b)];
      const Complex less = w(ma - mb, na - nb), more = w(ma + mb, na + nb);
      normal(1 + half + a, 1 + b) = 0.5 * (-more.imag() - less.imag());
      if (b > a) continue;
      normal(1 + a, 1 + b) = 0.5 * (less.real() + more.real());
      normal(1 + half + a, 1 + half + b) = 0.5 * (less.real() - more.real());
    }
  }
  normal.diagonal().array() += 0.5 * kRidge * static_cast<double>(pixels_);
  const Eigen::LLT<Eigen::MatrixXd> llt(normal);
  if (llt.info() != Eigen::Success) return std::nullopt;
  const Eigen::VectorXd c = llt.solve(r);
  std::vector<Complex> series(static_cast<std::size_t>(wide * wide));
  for (int a = 0; a < half; ++a) {
    const Complex value(0.5 * c(1 + a), -0.5 * c(1 + half + a));
    series[static_cast<std::size_t>(half + 1 + a)] = value;
    series[static_cast<std::size_t>(half - 1 - a)] = std::conj(value);
  }
  return PrintTemplate(order_, series);
}

}  // namespace moiregauge
