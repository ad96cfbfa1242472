// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/fit/print_bins.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Core>
#include <unsupported/Eigen/FFT>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using Complex = std::complex<double>;

// Bins per period of the highest harmonic. A pixel is shared among the 4 x 4 bins round it as a cubic B-spline has it,
// which acts on a harmonic of k periods as sinc^4(k / side), taken out again, and folds (k / (side - k))^4 of others
// into it: 1e-4 at worst, 2e-3 of the weights, whose orders go twice as far.
constexpr int kBinsPerPeriod = 12;
constexpr int kMinBins = 48;
// Relative to the mean weight: enough to keep a series that the bins leave open from running away, 1e-6 of what they
// say.
constexpr double kRidge = 1e-6;
constexpr long kMinPixelsPerCoefficient = 4;

double sinc(double x) { return x == 0.0 ? 1.0 : std::sin(kPi * x) / (kPi * x); }

// a * b in blocks of a fixed depth: how Eigen cuts a deeper sum depends on the machine's caches, and so would its bits.
Eigen::MatrixXd product(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::Ref<const Eigen::MatrixXd>& b) {
  constexpr Eigen::Index kDepth = 128;
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(a.rows(), b.cols());
  for (Eigen::Index k = 0; k < a.cols(); k += kDepth) {
    const Eigen::Index depth = std::min(kDepth, a.cols() - k);
    out.noalias() += a.middleCols(k, depth) * b.middleRows(k, depth);
  }
  return out;
}

// sum over pixels of value exp(-2 pi i (m X + n Y)) for |m|, |n| <= highest, from what they left in the bins; n
// slowest. As products of matrices: so few orders of so many bins are wanted that a fast transform is the slower way.
std::vector<Complex> spectrum(const std::vector<double>& value, int side, int highest) {
  const int wide = 2 * highest + 1;
  Eigen::MatrixXd c(side, highest + 1), s(side, highest + 1);
  std::vector<Complex> turn;
  for (int k = 0; k < side; ++k) turn.push_back(std::polar(1.0, kTwoPi * k / side));
  for (int m = 0; m <= highest; ++m) {
    for (int j = 0; j < side; ++j) {
      const Complex t = turn[static_cast<std::size_t>((j * m) % side)];
      c(j, m) = t.real();
      s(j, m) = t.imag();
    }
  }
  // A column of the bins, x, is a column of this: the map has y slowest.
  const Eigen::Map<const Eigen::MatrixXd> bins(value.data(), side, side);
  const Eigen::MatrixXd ct = c.transpose(), st = s.transpose();
  const Eigen::MatrixXd xc = product(ct, bins), xs = product(st, bins);  // orders of x by bins of y
  const Eigen::MatrixXd cc = product(xc, c), cs = product(xc, s), sc = product(xs, c), ss = product(xs, s);
  std::vector<Complex> sums(static_cast<std::size_t>(wide * wide));
  const auto at = [&](int m, int n) -> Complex& {
    return sums[static_cast<std::size_t>((n + highest) * wide + m + highest)];
  };
  for (int n = 0; n <= highest; ++n) {
    for (int m = 0; m <= highest; ++m) {
      const double shared = std::pow(sinc(double(m) / side) * sinc(double(n) / side), 4);
      const Complex same{cc(m, n) - ss(m, n), -(cs(m, n) + sc(m, n))}, other{cc(m, n) + ss(m, n), cs(m, n) - sc(m, n)};
      at(m, n) = same / shared;
      at(-m, -n) = std::conj(same) / shared;
      at(m, -n) = other / shared;
      at(-m, n) = std::conj(other) / shared;
    }
  }
  return sums;
}

// Cubic B-spline: shares of the four bins from the one before `at`'s on; f is how far `at` lies beyond its bin.
std::array<double, 4> shares(double f) {
  const double g = 1.0 - f, f2 = f * f, g2 = g * g;
  return {g * g2 / 6.0, (4.0 - 3.0 * f2 * (2.0 - f)) / 6.0, (4.0 - 3.0 * g2 * (2.0 - g)) / 6.0, f * f2 / 6.0};
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
constexpr int kMaxSteps = 60;
constexpr double kSmallEnough = 1e-9;  // residual against the right side

Eigen::VectorXcd solved(DifferenceMatrix& normal, double ridge, const Eigen::VectorXcd& right) {
  Eigen::VectorXcd x = Eigen::VectorXcd::Zero(right.size()), r = right, p = r;
  double rr = r.squaredNorm();
  const double enough = kSmallEnough * kSmallEnough * rr;
  for (int step = 0; step < kMaxSteps && rr > enough; ++step) {
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
      side_(std::max(kMinBins, kBinsPerPeriod * order)),
      count_(static_cast<std::size_t>(side_ * side_)),
      sum_(static_cast<std::size_t>(side_ * side_)) {}

void PrintBins::add(PrintPoint p, double grey) {
  const double x = (p.x - std::floor(p.x)) * side_, y = (p.y - std::floor(p.y)) * side_;
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const auto across = shares(x - i), down = shares(y - j);
  const auto inside = [this](int k) { return k < 0 ? k + side_ : k < side_ ? k : k - side_; };
  const std::array<int, 4> column{inside(i - 1), inside(i), inside(i + 1), inside(i + 2)};
  for (int v = 0; v < 4; ++v) {
    const auto row = static_cast<std::size_t>(inside(j - 1 + v) * side_);
    for (std::size_t u = 0; u < 4; ++u) {
      const double share = down[static_cast<std::size_t>(v)] * across[u];
      const std::size_t bin = row + static_cast<std::size_t>(column[u]);
      count_[bin] += share;
      sum_[bin] += share * grey;
    }
  }
  ++pixels_;
}

std::optional<PrintTemplate> PrintBins::fit() const {
  const int wide = 2 * order_ + 1, unknowns = wide * wide;
  if (pixels_ < kMinPixelsPerCoefficient * unknowns) return std::nullopt;
  // The normal equations of exponentials depend on differences of their orders only.
  const auto weight = spectrum(count_, side_, 2 * order_);
  const auto right = spectrum(sum_, side_, order_);
  DifferenceMatrix normal(weight, order_);
  const Eigen::VectorXcd c =
      solved(normal, kRidge * static_cast<double>(pixels_), Eigen::Map<const Eigen::VectorXcd>(right.data(), unknowns));
  const std::vector<Complex> series(c.data(), c.data() + unknowns);
  return PrintTemplate(order_, series);
}

}  // namespace moiregauge::internal
