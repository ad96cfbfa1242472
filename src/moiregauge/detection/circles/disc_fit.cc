// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/circles/disc_fit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "moiregauge/units/units.h"

namespace moiregauge::internal::markers_detail {
namespace {

constexpr double kMinBand = 2.0;          // px to either side of the edge
constexpr double kMaxBand = 6.0;          // px
constexpr double kBandInBlurs = 3.0;      // sigma: pixels farther from the edge hold no information about it
constexpr double kBandShare = 0.3;        // relative to the minor axis: keeps neighbouring markers out
constexpr double kMinDiscBlur = 0.25;     // px, sigma: a box pixel alone has 0.29
constexpr double kMaxBlur = 4.0;          // px, sigma (chosen)
constexpr double kMaxStray = 0.5;         // px from the traced centre (chosen)
constexpr std::size_t kMaxPixels = 6000;  // limits the time of the fine passes

// One disc must have one centre, for any traced outline (in a window or the whole image, from 8 or 16 bits). The fine
// passes therefore converge on a band whose ellipse is rounded to a coarse grid, which is the same for all traces.
constexpr double kSnap = 0.25;  // px
constexpr int kCoarsePasses = 2;
constexpr int kFinePasses = 4;

// Order: lighter level, its two slopes across the unit circle, q, sigma (relative step), k0 .. k4 of
// Ellipse::corrected.
constexpr int kDiscParameters = 10;
using DiscVector = Eigen::Matrix<double, kDiscParameters, 1>;
using DiscNormal = Eigen::Matrix<double, kDiscParameters, kDiscParameters>;

struct BandPixel {
  float x, y;
  double grey;
};

struct DiscState {
  Ellipse ellipse;
  double light = 0.0, slope_x = 0.0, slope_y = 0.0, q = 0.0, sigma = 1.0;
  bool dark_disc = true;
};

template <typename Grey>
std::vector<BandPixel> band_of(const ImageView<Grey>& view, const Ellipse& ellipse, double blur_px) {
  const auto shape = ellipse.shape();
  const double room = std::clamp(kBandShare * 2.0 * shape.minor_px, kMinBand, kMaxBand);
  const double width = std::clamp(kBandInBlurs * blur_px, kMinBand, room);
  const Eigen::Matrix2d inverse = ellipse.axes.inverse();
  const Eigen::Vector2d half = (ellipse.axes * ellipse.axes).diagonal().cwiseSqrt().array() + width + 1.0;
  const int x0 = std::max(0, static_cast<int>(ellipse.centre.x() - half.x()));
  const int x1 = std::min(view.width - 1, static_cast<int>(ellipse.centre.x() + half.x()) + 1);
  const int y0 = std::max(0, static_cast<int>(ellipse.centre.y() - half.y()));
  const int y1 = std::min(view.height - 1, static_cast<int>(ellipse.centre.y() + half.y()) + 1);
  // Most pixels of the box are far from the edge. The test on squares avoids their square root.
  constexpr double kRounding = 1e-9;
  const double share = width / shape.minor_px;
  const double most = (1.0 + share) * (1.0 + share) * (1.0 + kRounding);
  const double least = share < 1.0 ? (1.0 - share) * (1.0 - share) * (1.0 - kRounding) : 0.0;
  std::vector<BandPixel> band;
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const Eigen::Vector2d u = inverse * (Eigen::Vector2d(x, y) - ellipse.centre);
      const double square = u.squaredNorm();
      if (square > most || square < least) continue;
      const double rho = std::sqrt(square);
      if ((rho - 1.0) * shape.minor_px > width || (1.0 - rho) * shape.minor_px > width) continue;
      const double distance = (rho - 1.0) * rho / std::max((inverse * u).norm(), 1e-12);  // Sampson
      if (std::abs(distance) > width) continue;
      band.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<double>(view.at(x, y))});
    }
  }
  return band;
}

Ellipse snapped(Ellipse ellipse) {
  const auto to_grid = [](double v) { return std::round(v / kSnap) * kSnap; };
  ellipse.centre = ellipse.centre.unaryExpr(to_grid);
  ellipse.axes = ellipse.axes.unaryExpr(to_grid);
  return ellipse;
}

struct DiscSums {
  DiscNormal normal = DiscNormal::Zero();
  DiscVector right = DiscVector::Zero();
  double squares = 0.0;
  std::size_t pixels = 0;
};

DiscSums sums_of_band(const std::vector<BandPixel>& band, const DiscState& s, std::size_t stride) {
  DiscSums sums;
  const Eigen::Matrix2d inverse = s.ellipse.axes.inverse();
  const double side = s.dark_disc ? 1.0 : -1.0;
  DiscVector j;
  for (std::size_t i = 0; i < band.size(); i += stride) {
    const BandPixel& pixel = band[i];
    const Eigen::Vector2d u = inverse * Eigen::Vector2d(static_cast<double>(pixel.x) - s.ellipse.centre.x(),
                                                        static_cast<double>(pixel.y) - s.ellipse.centre.y());
    const double rho = std::max(u.norm(), 1e-6);
    const Eigen::Vector2d gradient = inverse * u / rho;
    const double per_px = 1.0 / std::max(gradient.norm(), 1e-9);
    const double distance = (rho - 1.0) * per_px;
    const double z = side * distance / s.sigma;
    const double darkness = 0.5 * std::erfc(z * std::sqrt(0.5));  // 1 on the dark side
    const double bell = std::exp(-0.5 * z * z) / std::sqrt(kTwoPi);
    const double plane = s.light + s.slope_x * u.x() + s.slope_y * u.y();
    const double rest = 1.0 - s.q * darkness;
    const double residual = pixel.grey - plane * rest;
    // d(darkness) = -bell dz. Moving the outline outwards by k radii lowers the distance by k * per_px.
    const double by_outline = -plane * s.q * bell * side / s.sigma * per_px;
    const double c = u.x() / rho, sn = u.y() / rho;
    j << rest, rest * u.x(), rest * u.y(), -plane * darkness, -plane * s.q * bell * z, by_outline, by_outline * c,
        by_outline * sn, by_outline * (c * c - sn * sn), by_outline * 2.0 * c * sn;
    sums.normal.noalias() += j * j.transpose();
    sums.right += j * residual;
    sums.squares += residual * residual;
    ++sums.pixels;
  }
  return sums;
}

// Applies one Gauss-Newton step. Empty if the step is not finite or moves the outline by more than half a radius.
std::optional<DiscVector> improve_disc(const DiscSums& sums, DiscState& s) {
  const Eigen::LDLT<DiscNormal> solver(DiscNormal(sums.normal.selfadjointView<Eigen::Lower>()));
  const DiscVector step = solver.solve(sums.right);
  if (!step.allFinite() || step.tail<5>().norm() > 0.5) return std::nullopt;
  s.light += step[0];
  s.slope_x += step[1];
  s.slope_y += step[2];
  s.q = std::clamp(s.q + step[3], 1e-3, 1.5);
  s.sigma = std::clamp(s.sigma * (1.0 + std::clamp(step[4], -0.4, 0.4)), kMinDiscBlur, kMaxBlur);
  s.ellipse = s.ellipse.corrected(step.tail<5>());
  return step;
}

template <typename Grey>
std::optional<FittedDisc> fit_in(const ImageView<Grey>& view, const TracedOutline& outline) {
  const double inside = outline.background + outline.contrast;
  DiscState s;
  s.ellipse = outline.ellipse;
  s.dark_disc = outline.contrast < 0.0;
  s.light = std::max(inside, outline.background);
  if (s.light <= 0.0) return std::nullopt;
  s.q = std::clamp(std::abs(outline.contrast) / s.light, 1e-3, 1.2);
  s.sigma = std::clamp(outline.blur_px, 0.5, 2.5);
  std::vector<BandPixel> band = band_of(view, s.ellipse, s.sigma);
  if (band.size() < 3 * kDiscParameters) return std::nullopt;
  const std::size_t coarse = 1 + band.size() / 400;
  for (int pass = 0; pass < kCoarsePasses; ++pass) {  // about 400 pixels suffice for the first steps
    if (!improve_disc(sums_of_band(band, s, coarse), s)) return std::nullopt;
  }
  band = band_of(view, snapped(s.ellipse), std::ceil(s.sigma / kSnap) * kSnap);
  if (band.size() < 3 * kDiscParameters) return std::nullopt;
  const std::size_t fine = 1 + band.size() / kMaxPixels;
  DiscSums sums;
  double gain = 0.0;
  for (int pass = 0; pass < kFinePasses; ++pass) {
    sums = sums_of_band(band, s, fine);
    const auto step = improve_disc(sums, s);
    if (!step) return std::nullopt;
    gain = sums.right.dot(*step);  // reduction of the sum of squares by this step, to first order
  }
  if ((s.ellipse.centre - outline.ellipse.centre).norm() > kMaxStray) return std::nullopt;
  const double freedom = static_cast<double>(sums.pixels) - kDiscParameters;
  const double variance = std::max(sums.squares - gain, 0.0) / freedom;
  const DiscNormal covariance = variance * DiscNormal(sums.normal.selfadjointView<Eigen::Lower>()).inverse();
  const Eigen::Matrix2d centre = s.ellipse.axes * covariance.block<2, 2>(6, 6) * s.ellipse.axes.transpose();
  return FittedDisc{s.ellipse, std::sqrt(0.5 * centre.trace()), std::sqrt(variance), s.sigma};
}

}  // namespace

std::optional<FittedDisc> fit_disc(const LumaView& luma, const TracedOutline& outline) {
  return std::visit([&](const auto& view) { return fit_in(view, outline); }, luma);
}

}  // namespace moiregauge::internal::markers_detail
