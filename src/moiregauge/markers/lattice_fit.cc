// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/markers/lattice_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "moiregauge/units/units.h"

namespace moiregauge {
namespace {

constexpr int kMostPixels = 3000;
constexpr int kPasses = 6;

struct Pixel {
  Eigen::Vector2d x;  // from the lattice's origin
  double grey = 0.0;
};

// Pixels at an even spacing inside the box, at most about kMostPixels of them.
std::vector<Pixel> pixels_in(const Image<float>& grey, const PhiBox& box, const Eigen::Matrix2d& to_phi, const Lattice& lattice) {
  const Eigen::Vector2d size = box.high - box.low;
  const double per_px = std::sqrt(std::abs((to_phi.inverse() * lattice.k).determinant()));
  const double px = std::sqrt(size.prod()) / per_px;
  const double step = std::max(1.0, px / std::sqrt(double{kMostPixels})) * per_px;
  std::vector<Pixel> out;
  for (double v = box.low.y() + 0.5 * step; v < box.high.y(); v += step) {
    for (double u = box.low.x() + 0.5 * step; u < box.high.x(); u += step) {
      const ImagePoint p = lattice.at(to_phi * Eigen::Vector2d(u, v));
      const double xr = std::round(p.x), yr = std::round(p.y);
      if (!(xr >= 0 && yr >= 0 && xr < grey.width() && yr < grey.height())) continue;
      const int x = static_cast<int>(xr), y = static_cast<int>(yr);
      out.push_back({{x - lattice.origin.x, y - lattice.origin.y}, double{grey.at(x, y)}});
    }
  }
  return out;
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

// One row of the linearised model: the series' terms, then d grey / d (k1, k2, q).
void fill_row(const LatticeModel& model, const Pixel& pixel, bool solves_lattice, bool perspective, Eigen::VectorXd& row) {
  const Lattice& l = model.lattice;
  const double w = 1.0 + l.q.dot(pixel.x);
  const Eigen::Vector2d phi = l.k * pixel.x / w;
  Eigen::Vector2d slope(0, 0);
  Eigen::Index at = 0;
  row[at++] = 1.0;
  for (const Eigen::Vector2i& h : model.harmonics) {
    const double angle = kTurn * h.cast<double>().dot(phi), c = std::cos(angle), s = std::sin(angle);
    slope += kTurn * (model.coefficients[at + 1] * c - model.coefficients[at] * s) * h.cast<double>();
    row[at++] = c;
    row[at++] = s;
  }
  if (!solves_lattice) return;
  row.segment<2>(at) = slope.x() * pixel.x / w;
  at += 2;
  if (!l.lines) {
    row.segment<2>(at) = slope.y() * pixel.x / w;
    at += 2;
  }
  if (perspective) row.segment<2>(at) = -slope.dot(phi) * pixel.x / w;
}

bool improve(const std::vector<Pixel>& pixels, bool solves_lattice, bool perspective, LatticeModel& model) {
  Lattice& l = model.lattice;
  const Eigen::Index series = model.coefficients.size();
  const Eigen::Index n = series + (solves_lattice ? (l.lines ? 2 : 4) + (perspective ? 2 : 0) : 0);
  if (static_cast<Eigen::Index>(pixels.size()) < 2 * n) return false;
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(pixels.size()), n);
  Eigen::VectorXd left(rows.rows()), row(n);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const Pixel& pixel = pixels[static_cast<std::size_t>(i)];
    fill_row(model, pixel, solves_lattice, perspective, row);
    rows.row(i) = row;
    left[i] = pixel.grey - row.head(series).dot(model.coefficients);
  }
  // Columns differ by powers of ten in size; scaled, the normal equations are well behaved, and a trace of damping keeps
  // terms that pixels this coarse cannot tell apart from running away.
  Eigen::VectorXd scale = rows.colwise().norm().transpose().cwiseMax(1e-9);
  rows = rows * scale.cwiseInverse().asDiagonal();
  Eigen::MatrixXd normal = rows.transpose() * rows;
  normal.diagonal().array() += 1e-6;
  Eigen::VectorXd step = normal.ldlt().solve(rows.transpose() * left);
  if (!step.allFinite()) return false;
  model.residual = (left - rows * step).norm() / std::sqrt(double(rows.rows()));
  step = step.cwiseQuotient(scale);
  model.coefficients += step.head(series);
  model.sigma = std::sqrt(0.5) * model.coefficients.tail(series - 1).norm();
  if (!solves_lattice) return true;
  Eigen::Index at = series;
  l.k.row(0) += step.segment<2>(at).transpose();
  at += 2;
  if (l.lines) {
    l.k.row(1) << -l.k(0, 1), l.k(0, 0);
  } else {
    l.k.row(1) += step.segment<2>(at).transpose();
    at += 2;
  }
  if (perspective) l.q += step.segment<2>(at);
  return std::abs(l.k.determinant()) > 1e-9;
}

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
  double sum = coefficients[0];
  for (std::size_t i = 0; i < harmonics.size(); ++i) {
    const double angle = kTurn * harmonics[i].cast<double>().dot(phi);
    const auto at = static_cast<Eigen::Index>(1 + 2 * i);
    sum += coefficients[at] * std::cos(angle) + coefficients[at + 1] * std::sin(angle);
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

bool fit_lattice(const Image<float>& grey, const PhiBox& box, const Eigen::Matrix2d& to_phi, int order, bool perspective,
                 LatticeModel& model) {
  const std::vector<Pixel> pixels = pixels_in(grey, box, to_phi, model.lattice);
  model.harmonics = harmonics_up_to(order, model.lattice.lines);
  model.coefficients = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(1 + 2 * model.harmonics.size()));
  for (int pass = 0; pass <= kPasses; ++pass) {
    // The series first: without it the lattice has no slope to follow. And last, so that it is that of the final lattice.
    if (!improve(pixels, pass > 0 && pass < kPasses, perspective, model)) return false;
  }
  return true;
}

double grey_at(const Image<float>& grey, ImagePoint p) {
  const double fx = std::floor(p.x), fy = std::floor(p.y);
  if (!(fx >= 0 && fy >= 0 && fx + 1 < grey.width() && fy + 1 < grey.height())) return std::numeric_limits<double>::quiet_NaN();
  const int x = static_cast<int>(fx), y = static_cast<int>(fy);
  const double a = p.x - fx, b = p.y - fy;
  return (1 - b) * ((1 - a) * double{grey.at(x, y)} + a * double{grey.at(x + 1, y)}) +
         b * ((1 - a) * double{grey.at(x, y + 1)} + a * double{grey.at(x + 1, y + 1)});
}

}  // namespace moiregauge
