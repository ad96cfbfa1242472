// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/fit/print_bins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Core>
#include <unsupported/Eigen/FFT>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using Complex = std::complex<double>;

// Bins per period of the highest harmonic. A cubic B-spline shares each pixel among 4 x 4 bins. Its response to a
// harmonic of k periods is sinc^4(k / side), which is divided out (decision 0019). Other harmonics fold into it by (k /
// (side - k))^4. This is at most 1e-4, or 2e-3 for the weights, whose orders are twice as high.
constexpr int kBinsPerPeriod = 12;
// Chosen.
constexpr int kMinBins = 48;
// Ridge relative to the mean weight. It bounds coefficients that the bins do not determine, and changes the others by
// 1e-6. Chosen.
constexpr double kRidge = 1e-6;
// Chosen.
constexpr long kMinPixelsPerCoefficient = 4;

double sinc(double x) { return x == 0.0 ? 1.0 : std::sin(kPi * x) / (kPi * x); }

// Returns a * b in blocks of fixed depth. Eigen splits a deeper sum by the machine's cache sizes, which would change
// its bits.
Eigen::MatrixXd product(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::Ref<const Eigen::MatrixXd>& b) {
  constexpr Eigen::Index kDepth = 128;
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(a.rows(), b.cols());
  for (Eigen::Index k = 0; k < a.cols(); k += kDepth) {
    const Eigen::Index depth = std::min(kDepth, a.cols() - k);
    out.noalias() += a.middleCols(k, depth) * b.middleRows(k, depth);
  }
  return out;
}

// Returns the sum over pixels of value exp(-2 pi i (m X + n Y)) for |m|, |n| <= highest, from the bins; n slowest.
// Matrix products are faster than a fast transform, because few orders of many bins are needed (decision 0019).
std::vector<Complex> spectrum(const std::vector<double>& value, int side, int highest) {
  const int wide = 2 * highest + 1;
  Eigen::MatrixXd c(side, highest + 1), s(side, highest + 1);
  std::vector<Complex> turn;
  turn.reserve(static_cast<std::size_t>(side));
  for (int k = 0; k < side; ++k) turn.push_back(std::polar(1.0, kTwoPi * k / side));
  for (int m = 0; m <= highest; ++m) {
    for (int j = 0; j < side; ++j) {
      const Complex t = turn[static_cast<std::size_t>((j * m) % side)];
      c(j, m) = t.real();
      s(j, m) = t.imag();
    }
  }
  // Eigen stores columns first: a column of the map contains the bins along x.
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

// Returns the largest whole number up to `value`, a few pitches. std::floor would be a call.
double floor_of(double value) {
  const int whole = static_cast<int>(value);
  return whole > value ? whole - 1 : whole;
}

// Returns the cubic B-spline's shares of four bins, from the one before the pixel's on. `f` is the pixel's distance
// beyond its bin, 0 to 1.
inline std::array<double, 4> shares(double f) {
  const double g = 1.0 - f, f2 = f * f, g2 = g * g;
  return {g * g2 / 6.0, (4.0 - 3.0 * f2 * (2.0 - f)) / 6.0, (4.0 - 3.0 * g2 * (2.0 - g)) / 6.0, f * f2 / 6.0};
}

// Product of a vector of orders with a matrix whose entries depend on differences of orders only. It is a convolution,
// computed by spectra on a grid of points wide enough for all differences. A direct solution would cost the sixth power
// of the order. All vectors belong to real functions. So half of the orders determines the others, and two rows of
// points fit into one complex transform.
class DifferenceMatrix {
 public:
  DifferenceMatrix(const std::vector<Complex>& weight, int order) : order_(order) {
    while (side_ < 4 * order + 1) side_ *= 2;
    line_.resize(side_), turned_.resize(side_), weight_.resize(side_, side_);
    half_.resize(side_, 2 * order + 1);
    spread(weight.data(), 2 * order);
    for (int y = 0; y < side_; y += 2) {
      points_of(y, 2 * order);
      weight_.col(y) = turned_.real(), weight_.col(y + 1) = turned_.imag();
    }
  }

  [[nodiscard]] Eigen::VectorXcd operator*(const Eigen::VectorXcd& c) {
    spread(c.data(), order_);
    for (int y = 0; y < side_; y += 2) {
      points_of(y, order_);
      turned_.real().array() *= weight_.col(y).array(), turned_.imag().array() *= weight_.col(y + 1).array();
      fft_.inv(line_.data(), turned_.data(), side_);
      for (int m = 0; m <= order_; ++m) {
        const Complex here = line_(m), there = std::conj(line_(index_of(-m)));
        const Complex even = here + there, odd = here - there;  // twice the first row, and 2i times the second
        half_(y, m) = {0.5 * even.real(), 0.5 * even.imag()};
        half_(y + 1, m) = {0.5 * odd.imag(), -0.5 * odd.real()};
      }
    }
    return gathered();
  }

 private:
  [[nodiscard]] int index_of(int order) const { return order < 0 ? order + side_ : order; }

  // Transforms along y for m >= 0. `c`: orders from -most to most along both axes, n slowest.
  void spread(const Complex* c, int most) {
    const int wide = 2 * most + 1;
    for (int m = 0; m <= most; ++m) {
      line_.setZero();
      for (int n = -most; n <= most; ++n) line_(index_of(n)) = c[(n + most) * wide + m + most];
      fft_.fwd(half_.col(m).data(), line_.data(), side_);
    }
  }

  // Transforms rows y (real part of `turned_`) and y + 1 (imaginary part) along x.
  void points_of(int y, int most) {
    line_.setZero();
    for (int m = 0; m <= most; ++m) {
      const Complex a = half_(y, m), b = half_(y + 1, m);
      line_(m) = {a.real() - b.imag(), a.imag() + b.real()};
      if (m > 0) line_(side_ - m) = {a.real() + b.imag(), b.real() - a.imag()};
    }
    fft_.fwd(turned_.data(), line_.data(), side_);
  }

  // Transforms back along y.
  [[nodiscard]] Eigen::VectorXcd gathered() {
    const int wide = 2 * order_ + 1;
    Eigen::VectorXcd out(wide * wide);
    for (int m = 0; m <= order_; ++m) {
      fft_.inv(line_.data(), half_.col(m).data(), side_);
      for (int n = -order_; n <= order_; ++n) {
        const Complex value = line_(index_of(n));
        out((n + order_) * wide + m + order_) = value;
        if (m > 0) out((order_ - n) * wide + order_ - m) = std::conj(value);
      }
    }
    return out;
  }

  int order_, side_ = 2;
  Eigen::FFT<double> fft_;
  Eigen::VectorXcd line_, turned_;
  Eigen::MatrixXcd half_;   // points along y, orders m >= 0
  Eigen::MatrixXd weight_;  // points along x, points along y
};

// Limits of the conjugate gradients. The window shows all parts of the grating about equally often, so the error falls
// several times per step. Parts that it does not show stay near zero. Chosen.
constexpr int kMaxSteps = 60;
constexpr double kSmallEnough = 1e-9;  // residual relative to the right-hand side

// Solves from the start `x`.
Eigen::VectorXcd solved(DifferenceMatrix& normal, double ridge, const Eigen::VectorXcd& right, Eigen::VectorXcd x) {
  Eigen::VectorXcd r = right;
  if (!x.isZero(0.0)) r -= normal * x + ridge * x;
  Eigen::VectorXcd p = r;
  double rr = r.squaredNorm();
  const double enough = kSmallEnough * kSmallEnough * right.squaredNorm();
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
      bins_(static_cast<std::size_t>(side_ * side_)) {}

void PrintBins::add(PrintPoint p, double grey) {
  const double x = (p.x - floor_of(p.x)) * side_, y = (p.y - floor_of(p.y)) * side_;
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const auto across = shares(x - i), down = shares(y - j);
  const auto inside = [this](int k) { return k < 0 ? k + side_ : k < side_ ? k : k - side_; };
  const std::array<int, 4> column{inside(i - 1), inside(i), inside(i + 1), inside(i + 2)};
  for (int v = 0; v < 4; ++v) {
    const auto row = static_cast<std::size_t>(inside(j - 1 + v) * side_);
    for (std::size_t u = 0; u < 4; ++u) {
      const double share = down[static_cast<std::size_t>(v)] * across[u];
      Bin& bin = bins_[row + static_cast<std::size_t>(column[u])];
      bin.count += share;
      bin.sum += share * grey;
    }
  }
  ++pixels_;
}

std::optional<PrintSeries> PrintBins::fit(const PrintSeries* near) const {
  const int wide = 2 * order_ + 1, unknowns = wide * wide;
  if (pixels_ < kMinPixelsPerCoefficient * unknowns) return std::nullopt;
  std::vector<double> count(bins_.size()), sum(bins_.size());
  std::ranges::transform(bins_, count.begin(), &Bin::count);
  std::ranges::transform(bins_, sum.begin(), &Bin::sum);
  // The normal equations of exponentials depend only on differences of their orders.
  const auto weight = spectrum(count, side_, 2 * order_);
  const auto right = spectrum(sum, side_, order_);
  DifferenceMatrix normal(weight, order_);
  Eigen::VectorXcd start = Eigen::VectorXcd::Zero(unknowns);
  for (int k = 0; near != nullptr && k < unknowns; ++k)
    start(k) = near->coefficient(k % wide - order_, k / wide - order_);
  const Eigen::VectorXcd c = solved(normal, kRidge * static_cast<double>(pixels_),
                                    Eigen::Map<const Eigen::VectorXcd>(right.data(), unknowns), std::move(start));
  const std::vector<Complex> series(c.data(), c.data() + unknowns);
  return PrintSeries(order_, series);
}

}  // namespace moiregauge::internal
