// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/lattices/saddle_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "moiregauge/units/units.h"

namespace moiregauge::internal::markers_detail {
namespace {

constexpr double kWindowShare = 0.4;     // relative to the spacing: keeps neighbouring corners outside
constexpr double kMinWindow = 2.5;       // px, radius
constexpr double kMaxWindow = 12.0;      // px, radius: in a larger window the lens bends the edges noticeably
constexpr double kMinSaddleBlur = 0.25;  // px, sigma: a box pixel alone has 0.29
constexpr double kStartBlur = 1.0;       // px, sigma
constexpr int kPasses = 10;
constexpr double kMaxTurn = 0.2;  // rad, largest rotation of an edge in one pass

// Order: lighter level and its two slopes, q, sigma (relative step), x, y, directions of the two edges.
constexpr int kSaddleParameters = 9;
using SaddleVector = Eigen::Matrix<double, kSaddleParameters, 1>;
using SaddleNormal = Eigen::Matrix<double, kSaddleParameters, kSaddleParameters>;

struct SaddleState {
  double light = 0.0, slope_x = 0.0, slope_y = 0.0, q = 0.0, sigma = kStartBlur;
  Eigen::Vector2d at{0, 0};             // px
  double angle_a = 0.0, angle_b = 0.0;  // rad, of the edges, from image x towards image y
  double side = 1.0;                    // +1: light on the same side of both edges; -1: dark there
};

struct DiscPixel {
  double x, y, grey;
};

template <typename Grey>
std::vector<DiscPixel> disc_of(const ImageView<Grey>& view, const Eigen::Vector2d& at, double radius) {
  std::vector<DiscPixel> pixels;
  const int x0 = static_cast<int>(std::ceil(at.x() - radius)), x1 = static_cast<int>(std::floor(at.x() + radius));
  const int y0 = static_cast<int>(std::ceil(at.y() - radius)), y1 = static_cast<int>(std::floor(at.y() + radius));
  if (x0 < 0 || y0 < 0 || x1 >= view.width || y1 >= view.height) return pixels;
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      if (std::hypot(x - at.x(), y - at.y()) > radius) continue;
      pixels.push_back({static_cast<double>(x), static_cast<double>(y), static_cast<double>(view.at(x, y))});
    }
  }
  return pixels;
}

template <typename Grey>
double grey_between(const ImageView<Grey>& view, double x, double y) {
  const int ix = std::min(static_cast<int>(x), view.width - 2), iy = std::min(static_cast<int>(y), view.height - 2);
  const double fx = x - ix, fy = y - iy;
  const double top = view.at(ix, iy) + fx * (view.at(ix + 1, iy) - view.at(ix, iy));
  const double low = view.at(ix, iy + 1) + fx * (view.at(ix + 1, iy + 1) - view.at(ix, iy + 1));
  return top + fy * (low - top);
}

struct SaddleSums {
  SaddleNormal normal = SaddleNormal::Zero();
  SaddleVector right = SaddleVector::Zero();
  double squares = 0.0;
};

SaddleSums sums_of_disc(const std::vector<DiscPixel>& pixels, const SaddleState& s) {
  SaddleSums sums;
  const Eigen::Vector2d along_a(std::cos(s.angle_a), std::sin(s.angle_a)),
      along_b(std::cos(s.angle_b), std::sin(s.angle_b));
  const Eigen::Vector2d normal_a(-along_a.y(), along_a.x()), normal_b(-along_b.y(), along_b.x());
  SaddleVector j;
  for (const DiscPixel& pixel : pixels) {
    const Eigen::Vector2d d(pixel.x - s.at.x(), pixel.y - s.at.y());
    const double za = normal_a.dot(d) / s.sigma, zb = normal_b.dot(d) / s.sigma;
    const double ea = std::erf(za * std::sqrt(0.5)), eb = std::erf(zb * std::sqrt(0.5));
    const double darkness = 0.5 * (1.0 - s.side * ea * eb);
    const double plane = s.light + s.slope_x * d.x() + s.slope_y * d.y();
    const double rest = 1.0 - s.q * darkness;
    const double residual = pixel.grey - plane * rest;
    // Derivatives of the grey level by za and zb. The slope of erf(z / sqrt 2) is 2 bell.
    const double bell_a = std::exp(-0.5 * za * za) / std::sqrt(kTwoPi),
                 bell_b = std::exp(-0.5 * zb * zb) / std::sqrt(kTwoPi);
    const double by_a = plane * s.q * s.side * eb * bell_a, by_b = plane * s.q * s.side * ea * bell_b;
    const Eigen::Vector2d by_at =
        -(by_a * normal_a + by_b * normal_b) / s.sigma - rest * Eigen::Vector2d(s.slope_x, s.slope_y);
    // A rotation of an edge by da changes its normal by -along da.
    j << rest, rest * d.x(), rest * d.y(), -plane * darkness, -(by_a * za + by_b * zb), by_at.x(), by_at.y(),
        -by_a * along_a.dot(d) / s.sigma, -by_b * along_b.dot(d) / s.sigma;
    sums.normal.selfadjointView<Eigen::Lower>().rankUpdate(j);
    sums.right += j * residual;
    sums.squares += residual * residual;
  }
  return sums;
}

bool improve_saddle(const SaddleSums& sums, double max_blur, SaddleState& s) {
  const Eigen::LDLT<SaddleNormal> solver(SaddleNormal(sums.normal.selfadjointView<Eigen::Lower>()));
  const SaddleVector step = solver.solve(sums.right);
  if (!step.allFinite()) return false;
  s.light += step[0];
  s.slope_x += step[1];
  s.slope_y += step[2];
  s.q = std::clamp(s.q + step[3], 1e-3, 1.5);
  s.sigma = std::clamp(s.sigma * (1.0 + std::clamp(step[4], -0.4, 0.4)), kMinSaddleBlur, max_blur);
  const Eigen::Vector2d move(step[5], step[6]);
  s.at += move / std::max(1.0, move.norm());
  s.angle_a += std::clamp(step[7], -kMaxTurn, kMaxTurn);
  s.angle_b += std::clamp(step[8], -kMaxTurn, kMaxTurn);
  return true;
}

double variance_of(const std::vector<DiscPixel>& pixels) {
  double sum = 0.0, squares = 0.0;
  for (const DiscPixel& p : pixels) {
    sum += p.grey;
    squares += p.grey * p.grey;
  }
  const auto n = static_cast<double>(pixels.size());
  return squares / n - sum * sum / (n * n);
}

// Sets the start levels: light and dark are the medians of the brightest and the darkest quarter of the pixels.
void start_levels(const std::vector<DiscPixel>& pixels, SaddleState& s) {
  std::vector<double> levels;
  levels.reserve(pixels.size());
  for (const DiscPixel& p : pixels) levels.push_back(p.grey);
  std::sort(levels.begin(), levels.end());
  s.light = levels[levels.size() * 7 / 8];
  s.q = std::clamp((s.light - levels[levels.size() / 8]) / std::max(s.light, 1.0), 1e-3, 1.2);
}

// Returns the contrast between the darker light and the lighter dark quadrant, relative to the fitted contrast. An
// outer corner of the pattern has one quadrant of the wrong colour, which the residual may not show.
double weakest_contrast(const std::vector<DiscPixel>& pixels, const SaddleState& s) {
  std::array<double, 4> sum{}, count{};
  const Eigen::Vector2d normal_a(-std::sin(s.angle_a), std::cos(s.angle_a)),
      normal_b(-std::sin(s.angle_b), std::cos(s.angle_b));
  for (const DiscPixel& pixel : pixels) {
    const Eigen::Vector2d d(pixel.x - s.at.x(), pixel.y - s.at.y());
    const double a = normal_a.dot(d), b = normal_b.dot(d);
    if (std::min(std::abs(a), std::abs(b)) < s.sigma) continue;  // excludes the edges
    const std::size_t quadrant = (a > 0.0 ? 1 : 0) + (b > 0.0 ? 2 : 0);
    sum[quadrant] += pixel.grey / (s.light + s.slope_x * d.x() + s.slope_y * d.y());
    count[quadrant] += 1.0;
  }
  for (std::size_t i = 0; i < 4; ++i) {
    if (count[i] == 0.0) return 0.0;
    sum[i] /= count[i];
  }
  // Quadrants 0 and 3 are on the same side of both edges.
  const double same = s.side * std::min(s.side * sum[0], s.side * sum[3]),
               other = s.side * std::max(s.side * sum[1], s.side * sum[2]);
  return s.side * (same - other) / s.q;
}

// Returns the correlation between the grey levels and those at opposite points. It is nearly 1 for a corner, and 1/3 if
// one of the four quadrants has the wrong colour. It does not depend on the fitted model.
template <typename Grey>
double point_symmetry(const ImageView<Grey>& view, const std::vector<DiscPixel>& pixels, const Eigen::Vector2d& at) {
  double n = 0.0, sum = 0.0, squares = 0.0, products = 0.0;
  for (const DiscPixel& p : pixels) {
    const double x = 2.0 * at.x() - p.x, y = 2.0 * at.y() - p.y;
    if (x < 0.0 || y < 0.0 || x > view.width - 1 || y > view.height - 1) continue;
    const double opposite = grey_between(view, x, y);
    n += 2.0;
    sum += p.grey + opposite;
    squares += p.grey * p.grey + opposite * opposite;
    products += 2.0 * p.grey * opposite;
  }
  if (n == 0.0) return 0.0;
  const double variance = squares / n - sum * sum / (n * n);
  return variance > 0.0 ? (products / n - sum * sum / (n * n)) / variance : 0.0;
}

template <typename Grey>
std::optional<FittedSaddle> fit_saddle_in(const ImageView<Grey>& view, const SaddleStart& start) {
  const Eigen::Vector2d a = start.step.col(0), b = start.step.col(1);
  const double spacing = std::min(a.norm(), b.norm());
  const double radius = std::clamp(kWindowShare * spacing, kMinWindow, kMaxWindow);
  SaddleState s;
  s.at = start.at;
  s.angle_a = std::atan2(a.y(), a.x());
  s.angle_b = std::atan2(b.y(), b.x());
  // A point between the steps is on opposite sides of the two edges.
  s.side = start.light_between ? -1.0 : 1.0;
  std::vector<DiscPixel> pixels = disc_of(view, s.at, radius);
  if (pixels.size() < 2 * kSaddleParameters) return std::nullopt;
  start_levels(pixels, s);
  if (s.light <= 0.0) return std::nullopt;
  SaddleSums sums;
  for (int pass = 0; pass < kPasses; ++pass) {
    if (pass == kPasses / 2) pixels = disc_of(view, s.at, radius);  // centres the window on the improved position, once
    if (pixels.size() < 2 * kSaddleParameters) return std::nullopt;
    sums = sums_of_disc(pixels, s);
    if (!improve_saddle(sums, 0.5 * radius, s)) return std::nullopt;
    if ((s.at - start.at).norm() > 0.5 * spacing) return std::nullopt;
  }
  sums = sums_of_disc(pixels, s);
  const double variance = sums.squares / (static_cast<double>(pixels.size()) - kSaddleParameters);
  const SaddleNormal covariance = variance * SaddleNormal(sums.normal.selfadjointView<Eigen::Lower>()).inverse();
  const double total = variance_of(pixels) * static_cast<double>(pixels.size());
  FittedSaddle out{.at = s.at,
                   .u_px = std::sqrt(0.5 * covariance.block<2, 2>(5, 5).trace()),
                   .contrast = s.q * s.light,
                   .symmetric = point_symmetry(view, pixels, s.at),
                   .weakest = weakest_contrast(pixels, s)};
  if (!(total > 0.0) || !std::isfinite(out.u_px)) return std::nullopt;
  out.explained = 1.0 - sums.squares / total;
  return out;
}

}  // namespace

std::optional<FittedSaddle> fit_saddle(const LumaView& luma, const SaddleStart& start) {
  return std::visit([&](const auto& view) { return fit_saddle_in(view, start); }, luma);
}

}  // namespace moiregauge::internal::markers_detail
