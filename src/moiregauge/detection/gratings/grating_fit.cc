// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/gratings/grating_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "moiregauge/detection/gratings/stratified_points.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr int kSeriesPasses = 2;  // before the lattice passes: without a series the lattice has no gradient
constexpr int kLatticePasses = 5;
constexpr int kUnknowns = 8;  // in the lattice: phases, k, q
// Per px, 1 sigma of the prior on q = tan(tilt) / focal length: a wide lens of 1000 px at 45 degrees. The prior limits
// q if the pixels do not determine it.
constexpr double kLikelyPerspective = 1e-3;

struct LatticePixel {
  Eigen::Vector2d x;  // px from the lattice's origin
  double grey = 0.0;
  double weight = 0.0;
};

double hann_at(double t) { return t > 0.0 && t < 1.0 ? 0.5 - 0.5 * std::cos(kTwoPi * t) : 0.0; }

class PixelPicker {
 public:
  PixelPicker(const Image<float>& grey, const PhiBox& box, const Lattice& lattice)
      : grey_(grey), box_(box), lattice_(lattice) {}
  void pick(int x, int y, const Eigen::Vector2d& in_print) {
    if (!(x >= 0 && y >= 0 && x < grey_.width() && y < grey_.height())) return;
    const Eigen::Vector2d t = (in_print - box_.low).cwiseQuotient(box_.high - box_.low);
    const double weight = hann_at(t.x()) * hann_at(t.y());
    if (weight > 0.0) out_.push_back({{x - lattice_.origin.x, y - lattice_.origin.y}, double{grey_.at(x, y)}, weight});
  }
  [[nodiscard]] std::vector<LatticePixel> taken() && { return std::move(out_); }

 private:
  const Image<float>& grey_;
  const PhiBox& box_;
  const Lattice& lattice_;
  std::vector<LatticePixel> out_;
};

// Returns all pixels of a small box, and about `most` stratified pixels of a large one. A regular choice would alias
// with the grating.
std::vector<LatticePixel> pixels_in(const Image<float>& grey, const PhiBox& box, const Eigen::Matrix2d& to_phi,
                                    const Lattice& lattice, std::size_t most) {
  const Eigen::Matrix2d from_phi = to_phi.inverse();
  const Eigen::Vector2d size = box.high - box.low;
  const double area = size.prod() / std::max(std::abs((from_phi * lattice.k).determinant()), 1e-12);
  PixelPicker picker(grey, box, lattice);
  if (area > static_cast<double>(most)) {
    const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(most)));
    for (std::size_t i = 0; i < side * side; ++i) {
      const Eigen::Vector2d s = box.low + size.cwiseProduct(markers_detail::stratified_in_square(i, side));
      const ImagePoint p = lattice.at(to_phi * s);
      if (!(std::abs(p.x) < 1e6 && std::abs(p.y) < 1e6)) continue;
      picker.pick(static_cast<int>(std::lround(p.x)), static_cast<int>(std::lround(p.y)), s);
    }
    return std::move(picker).taken();
  }
  Eigen::Vector2d low(1e6, 1e6), high(-1e6, -1e6);
  for (int corner = 0; corner < 4; ++corner) {
    const Eigen::Vector2d s((corner & 1 ? box.high : box.low).x(), (corner & 2 ? box.high : box.low).y());
    const ImagePoint p = lattice.at(to_phi * s);
    low = low.cwiseMin(Eigen::Vector2d(p.x, p.y));
    high = high.cwiseMax(Eigen::Vector2d(p.x, p.y));
  }
  if (!((high - low).prod() < 16.0 * static_cast<double>(most) + 1000.0)) return {};  // too oblique for a grating
  for (int y = static_cast<int>(std::ceil(low.y())); y <= high.y(); ++y) {
    for (int x = static_cast<int>(std::ceil(low.x())); x <= high.x(); ++x)
      picker.pick(x, y, from_phi * lattice.phi({static_cast<double>(x), static_cast<double>(y)}));
  }
  return std::move(picker).taken();
}

std::vector<Eigen::Vector2i> harmonics_up_to(int order, bool lines) {
  std::vector<Eigen::Vector2i> out;
  for (int m = 0; m <= order; ++m) {
    for (int n = lines ? 0 : -order; n <= (lines ? 0 : order); ++n) {
      if (m > 0 || n > 0) out.emplace_back(m, n);
    }
  }
  return out;
}

struct Wave {
  double c = 1.0;
  double s = 0.0;
};
Wave operator*(Wave a, Wave b) { return {a.c * b.c - a.s * b.s, a.s * b.c + a.c * b.s}; }

// Cosine and sine of all harmonics at one position, by products of the fundamentals.
class Waves {
 public:
  explicit Waves(const Eigen::Vector2d& phi) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double angle = kTwoPi * phi[static_cast<Eigen::Index>(axis)];
      powers_[axis][1] = {std::cos(angle), std::sin(angle)};
      for (std::size_t n = 2; n < powers_[axis].size(); ++n) powers_[axis][n] = powers_[axis][n - 1] * powers_[axis][1];
    }
  }
  [[nodiscard]] Wave of(const Eigen::Vector2i& h) const {
    Wave other = powers_[1][static_cast<std::size_t>(std::abs(h.y()))];
    if (h.y() < 0) other.s = -other.s;
    return powers_[0][static_cast<std::size_t>(h.x())] * other;
  }

 private:
  std::array<std::array<Wave, kHighestOrder + 1>, 2> powers_;
};

// One pass over the pixels: sums of the residuals for the series and for the lattice. Under the Hann weight over two
// periods or more, the harmonics are orthogonal within 2 %. A few passes therefore replace the solution of one large
// system.
class Pass {
 public:
  Pass(const std::vector<LatticePixel>& pixels, LatticeModel& model) : model_(model) {
    series_ = Eigen::VectorXd::Zero(model.coefficients.size());
    terms_.resize(series_.size());
    for (const LatticePixel& p : pixels) add(p);
  }
  void update_series() {
    // The mean square of a cosine is 1/2, hence the factor 2.
    model_.coefficients[0] += series_[0] / weight_;
    const Eigen::Index rest = series_.size() - 1;
    model_.coefficients.tail(rest) += 2.0 / weight_ * series_.tail(rest);
    model_.sigma = std::sqrt(0.5) * model_.coefficients.tail(rest).norm();
    model_.slope += light_.ldlt().solve(light_right_);
  }
  // Returns false if the pixels do not determine the lattice.
  bool update_lattice(bool perspective) {
    Lattice& l = model_.lattice;
    std::vector<Eigen::Index> unknowns{0, 2, 3};
    if (!l.lines) unknowns.insert(unknowns.end(), {1, 4, 5});
    if (perspective) {
      unknowns.insert(unknowns.end(), {6, 7});
      const double variance = squares_ / weight_, weight = variance / (kLikelyPerspective * kLikelyPerspective);
      normal_.diagonal().tail<2>().array() += weight;
      right_.tail<2>() -= weight * l.q;
    }
    const auto n = static_cast<Eigen::Index>(unknowns.size());
    Eigen::MatrixXd normal(n, n);
    Eigen::VectorXd right(n), scale(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Index a = unknowns[static_cast<std::size_t>(i)];
      scale[i] = std::sqrt(normal_(a, a));
      if (!(scale[i] > 0.0)) return false;
      right[i] = right_[a] / scale[i];
      for (Eigen::Index k = 0; k <= i; ++k) {
        const Eigen::Index b = unknowns[static_cast<std::size_t>(k)];
        normal(i, k) = normal(k, i) = normal_(std::max(a, b), std::min(a, b)) / scale[i] / scale[k];
      }
    }
    normal.diagonal().array() += 1e-9;
    const Eigen::VectorXd solved = normal.ldlt().solve(right).cwiseQuotient(scale);
    if (!solved.allFinite()) return false;
    Eigen::Matrix<double, kUnknowns, 1> step = Eigen::Matrix<double, kUnknowns, 1>::Zero();
    for (Eigen::Index i = 0; i < n; ++i) step[unknowns[static_cast<std::size_t>(i)]] = solved[i];
    // The phases (unknowns 0 and 1) belong to the series. They are solved here, and ignored, to decouple them from k
    // and q.
    l.k.row(0) += step.segment<2>(2).transpose();
    if (l.lines)
      l.k.row(1) << -l.k(0, 1), l.k(0, 0);
    else
      l.k.row(1) += step.segment<2>(4).transpose();
    l.q += step.segment<2>(6);
    return std::abs(l.k.determinant()) > 1e-9;
  }
  [[nodiscard]] double residual() const { return std::sqrt(squares_ / weight_); }
  [[nodiscard]] bool any() const { return weight_ > 0.0; }

 private:
  void add(const LatticePixel& p) {
    const Lattice& l = model_.lattice;
    const double w = 1.0 + l.q.dot(p.x);
    const Eigen::Vector2d phi = l.k * p.x / w;
    const Waves waves(phi);
    double value = model_.coefficients[0] + model_.slope.dot(p.x), slope1 = 0.0, slope2 = 0.0;
    for (std::size_t i = 0; i < model_.harmonics.size(); ++i) {
      const Wave wave = waves.of(model_.harmonics[i]);
      const auto at = static_cast<Eigen::Index>(1 + 2 * i);
      const double c = model_.coefficients[at], s = model_.coefficients[at + 1];
      const double turned = s * wave.c - c * wave.s;
      value += c * wave.c + s * wave.s;
      slope1 += turned * model_.harmonics[i].x();
      slope2 += turned * model_.harmonics[i].y();
      terms_[at] = wave.c;
      terms_[at + 1] = wave.s;
    }
    terms_[0] = 1.0;
    const double left = p.grey - value;
    weight_ += p.weight;
    squares_ += p.weight * left * left;
    series_ += (p.weight * left) * terms_;
    light_ += p.weight * p.x * p.x.transpose();
    light_right_ += p.weight * left * p.x;
    slope1 *= kTwoPi;
    slope2 *= kTwoPi;
    Eigen::Matrix<double, kUnknowns, 1> row;
    row << slope1, slope2, slope1 * p.x / w, slope2 * p.x / w, -(slope1 * phi.x() + slope2 * phi.y()) * p.x / w;
    normal_.selfadjointView<Eigen::Lower>().rankUpdate(row, p.weight);
    right_ += (p.weight * left) * row;
  }

  LatticeModel& model_;
  Eigen::VectorXd series_, terms_;
  Eigen::Matrix2d light_ = Eigen::Matrix2d::Zero();
  Eigen::Vector2d light_right_{0, 0};
  Eigen::Matrix<double, kUnknowns, kUnknowns> normal_ = Eigen::Matrix<double, kUnknowns, kUnknowns>::Zero();
  Eigen::Matrix<double, kUnknowns, 1> right_ = Eigen::Matrix<double, kUnknowns, 1>::Zero();
  double weight_ = 0.0;
  double squares_ = 0.0;
};

}  // namespace

Eigen::Vector2d Lattice::phi(ImagePoint p) const {
  const Eigen::Vector2d x(p.x - origin.x, p.y - origin.y);
  return k * x / (1.0 + q.dot(x));
}

ImagePoint Lattice::at(const Eigen::Vector2d& phi) const {
  const Eigen::Vector2d x = (k - phi * q.transpose()).inverse() * phi;
  return {origin.x + x.x(), origin.y + x.y()};
}

Eigen::Matrix2d Lattice::jacobian(ImagePoint p) const {
  const Eigen::Vector2d x(p.x - origin.x, p.y - origin.y);
  const double w = 1.0 + q.dot(x);
  return (k - (k * x / w) * q.transpose()) / w;
}

double LatticeModel::grey(const Eigen::Vector2d& phi) const {
  const Waves waves(phi);
  double sum = coefficients[0];
  for (std::size_t i = 0; i < harmonics.size(); ++i) {
    const Wave wave = waves.of(harmonics[i]);
    const auto at = static_cast<Eigen::Index>(1 + 2 * i);
    sum += coefficients[at] * wave.c + coefficients[at + 1] * wave.s;
  }
  return sum;
}

double LatticeModel::amplitude(int m, int n) const {
  for (std::size_t i = 0; i < harmonics.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(1 + 2 * i);
    if (harmonics[i] == Eigen::Vector2i(m, n)) return std::hypot(coefficients[at], coefficients[at + 1]);
  }
  return 0.0;
}

double LatticeModel::explained() const {
  const double signal = sigma * sigma, rest = residual * residual;
  return signal > 0.0 ? signal / (signal + rest) : 0.0;
}

bool fit_lattice(const Image<float>& grey, const PhiBox& box, const Eigen::Matrix2d& to_phi,
                 const LatticeFitOptions& options, LatticeModel& model) {
  const std::vector<LatticePixel> pixels = pixels_in(grey, box, to_phi, model.lattice, options.most_pixels);
  model.harmonics = harmonics_up_to(options.order, model.lattice.lines);
  model.coefficients = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(1 + 2 * model.harmonics.size()));
  model.slope.setZero();
  if (static_cast<Eigen::Index>(pixels.size()) < model.coefficients.size() + kUnknowns) return false;
  for (int pass = 0; pass < kSeriesPasses + kLatticePasses; ++pass) {
    Pass now(pixels, model);
    if (!now.any()) return false;
    now.update_series();
    if (pass >= kSeriesPasses && !now.update_lattice(options.perspective)) return false;
  }
  for (int pass = 0; pass < kSeriesPasses; ++pass) Pass(pixels, model).update_series();
  model.residual = Pass(pixels, model).residual();
  return std::isfinite(model.residual) && std::isfinite(model.sigma);
}

double grey_at(const Image<float>& grey, ImagePoint p) {
  const double fx = std::floor(p.x), fy = std::floor(p.y);
  if (!(fx >= 0 && fy >= 0 && fx + 1 < grey.width() && fy + 1 < grey.height()))
    return std::numeric_limits<double>::quiet_NaN();
  const int x = static_cast<int>(fx), y = static_cast<int>(fy);
  const double a = p.x - fx, b = p.y - fy;
  return (1 - b) * ((1 - a) * double{grey.at(x, y)} + a * double{grey.at(x + 1, y)}) +
         b * ((1 - a) * double{grey.at(x, y + 1)} + a * double{grey.at(x + 1, y + 1)});
}

}  // namespace moiregauge::internal
