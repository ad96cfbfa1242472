// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/print_bins.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <unsupported/Eigen/FFT>

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
  const auto bin = [side](int k) { return k < 0 ? k + side : k; };
  Eigen::FFT<double> fft;
  Eigen::MatrixXcd columns(side, wide);  // row by row transformed, the orders kept
  Eigen::VectorXcd line(side), out(side);
  for (int j = 0; j < side; ++j) {
    line = Eigen::Map<const Eigen::VectorXd>(value.data() + static_cast<std::ptrdiff_t>(j) * side, side);
    fft.fwd(out, line);
    for (int m = -highest; m <= highest; ++m) columns(j, m + highest) = out(bin(m));
  }
  std::vector<Complex> sums(static_cast<std::size_t>(wide * wide));
  for (int m = -highest; m <= highest; ++m) {
    line = columns.col(m + highest);
    fft.fwd(out, line);
    for (int n = -highest; n <= highest; ++n) {
      const double shared = sinc(double(m) / side) * sinc(double(n) / side);
      sums[static_cast<std::size_t>((n + highest) * wide + m + highest)] = out(bin(n)) / (shared * shared);
    }
  }
  return sums;
}

// A matrix whose entries depend on differences of orders only, times a vector of orders: a convolution, so products of
// spectra on a grid wide enough for all differences. A direct solution would cost the sixth power of the order.
class DifferenceMatrix {
 public:
  DifferenceMatrix(const std::vector<Complex>& weight, int order) : wide_(2 * order + 1) {
    while (side_ < 4 * order + 1) side_ *= 2;
    Grid grid = Grid::Zero(side_, side_);
    for (int n = -2 * order; n <= 2 * order; ++n) {
      for (int m = -2 * order; m <= 2 * order; ++m)
        grid((m + side_) % side_, (n + side_) % side_) =
            weight[static_cast<std::size_t>((n + 2 * order) * (4 * order + 1) + m + 2 * order)];
    }
    weight_ = transformed(grid, true);
  }

  [[nodiscard]] Eigen::VectorXcd operator*(const Eigen::VectorXcd& c) {
    Grid grid = Grid::Zero(side_, side_);
    grid.topLeftCorner(wide_, wide_) = Eigen::Map<const Grid>(c.data(), wide_, wide_);
    const Grid out = transformed(transformed(grid, true).cwiseProduct(weight_), false);
    Eigen::VectorXcd product(c.size());
    Eigen::Map<Grid>(product.data(), wide_, wide_) = out.topLeftCorner(wide_, wide_);
    return product;
  }

 private:
  using Grid = Eigen::MatrixXcd;

  [[nodiscard]] Grid transformed(Grid grid, bool forward) {
    Eigen::VectorXcd line(side_), out(side_);
    for (const bool columns : {true, false}) {
      for (int k = 0; k < side_; ++k) {
        if (columns)
          line = grid.col(k);
        else
          line = grid.row(k).transpose();
        if (forward)
          fft_.fwd(out, line);
        else
          fft_.inv(out, line);
        if (columns)
          grid.col(k) = out;
        else
          grid.row(k) = out.transpose();
      }
    }
    return grid;
  }

  int wide_, side_ = 1;
  Eigen::FFT<double> fft_;
  Grid weight_;
};

// Conjugate gradients. How often the window shows each part of the print differs by a small factor, so the error falls
// several times a step; what it does not show stays near zero.
constexpr int kMostSteps = 60;
constexpr double kSmallEnough = 1e-9;  // residual against the right side

Eigen::VectorXcd solved(DifferenceMatrix& normal, double ridge, const Eigen::VectorXcd& right) {
  Eigen::VectorXcd x = Eigen::VectorXcd::Zero(right.size()), r = right, p = r;
  double rr = r.squaredNorm();
  const double enough = kSmallEnough * kSmallEnough * rr;
  for (int step = 0; step < kMostSteps && rr > enough; ++step) {
    const Eigen::VectorXcd ap = normal * p + ridge * p;
    const double along = rr / p.dot(ap).real();
    x += along * p;
    r -= along * ap;
    const double next = r.squaredNorm();
    p = r + (next / rr) * p;
    rr = next;
  }
  return x;
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
  DifferenceMatrix normal(weight, order_);
  const Eigen::VectorXcd c =
      solved(normal, kRidge * static_cast<double>(pixels_), Eigen::Map<const Eigen::VectorXcd>(right.data(), unknowns));
  const std::vector<Complex> series(c.data(), c.data() + unknowns);
  return PrintTemplate(order_, series);
}

}  // namespace moiregauge
