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
// slowest.
std::vector<Complex> spectrum(const std::vector<double>& value, int side, int highest) {
  const int wide = 2 * highest + 1;
  std::vector<Complex> turn;
  for (int k = 0; k < side; ++k) turn.push_back(std::polar(1.0, -kTurn * k / side));
  const auto at = [&](int m, int i) {
    const int k = (m * i) % side;
    return turn[static_cast<std::size_t>(k < 0 ? k + side : k)];
  };
  std::vector<Complex> rows(static_cast<std::size_t>(side * wide)), out(static_cast<std::size_t>(wide * wide));
  for (int j = 0; j < side; ++j) {
    for (int m = -highest; m <= highest; ++m) {
      Complex sum = 0.0;
      for (int i = 0; i < side; ++i) sum += value[static_cast<std::size_t>(j * side + i)] * at(m, i);
      rows[static_cast<std::size_t>(j * wide + m + highest)] = sum;
    }
  }
  for (int n = -highest; n <= highest; ++n) {
    for (int m = 0; m < wide; ++m) {
      Complex sum = 0.0;
      for (int j = 0; j < side; ++j) sum += rows[static_cast<std::size_t>(j * wide + m)] * at(n, j);
      const double shared = sinc(double(m - highest) / side) * sinc(double(n) / side);
      out[static_cast<std::size_t>((n + highest) * wide + m)] = sum / (shared * shared);
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
  const int wide = 2 * order_ + 1, unknowns = wide * wide;
  if (pixels_ < kLeastPixelsPerUnknown * unknowns) return std::nullopt;
  // The normal equations of exponentials depend on differences of their orders only.
  const auto weight = spectrum(count_, side_, 2 * order_);
  const auto right = spectrum(sum_, side_, order_);
  Eigen::MatrixXcd normal(unknowns, unknowns);
  Eigen::VectorXcd r(unknowns);
  const int far = 4 * order_ + 1;
  for (int a = 0; a < unknowns; ++a) {
    r(a) = right[static_cast<std::size_t>(a)];
    for (int b = 0; b < unknowns; ++b) {
      const int m = a % wide - b % wide + 2 * order_, n = a / wide - b / wide + 2 * order_;
      normal(a, b) = weight[static_cast<std::size_t>(n * far + m)];
    }
  }
  normal.diagonal().array() += kRidge * static_cast<double>(pixels_);
  const Eigen::LLT<Eigen::MatrixXcd> llt(normal);
  if (llt.info() != Eigen::Success) return std::nullopt;
  const Eigen::VectorXcd c = llt.solve(r);
  const std::vector<Complex> series(c.data(), c.data() + unknowns);
  return PrintTemplate(order_, series);
}

}  // namespace moiregauge
