// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/rendering/print.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "moiregauge/simulator/scenario/gaussian.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::simulator {

Stripes::Stripes(double period, double half, double offset, double reach) {
  const int count = static_cast<int>(std::ceil(reach / period)) + 1;
  for (int n = -count - 1; n <= count; ++n) {
    const double middle = (n + offset) * period;
    const double low = std::max(middle - half, -reach), high = std::min(middle + half, reach);
    if (high <= low) continue;
    edges_.push_back(low);
    edges_.push_back(high);
  }
  space();
}

Stripes Stripes::box(double reach) {
  Stripes box;
  box.edges_ = {-reach, reach};
  box.space();
  return box;
}

double Stripes::seen(double x, double sigma) const {
  const double reach = kGaussianReach * sigma, per_sigma = 1.0 / sigma;
  std::size_t i = first_edge_after(x - reach);
  double sum = static_cast<double>(i & 1U);  // value left of edge i
  for (; i < edges_.size() && edges_[i] < x + reach; ++i) {
    const double passed = gaussian_below((x - edges_[i]) * per_sigma);
    sum += (i & 1U) == 0 ? passed : -passed;
  }
  return sum;
}

bool Stripes::is_even(double x, double distance) const {
  const std::size_t i = first_edge_after(x - distance);
  return i == edges_.size() || edges_[i] > x + distance;
}

namespace {

constexpr double kSmallDisc = 6.0;  // radius / sigma: below it the rim is too curved for the approximation by an edge

// Integrates a small disc over its chords at height radius * sin(turn), by Gauss-Legendre nodes in turn.
double seen_small_disc(double x, double y, double radius, const Blur& blur) {
  static const std::vector<Node> nodes = gauss_legendre(24);
  const double slant = blur.xy / blur.yy, own = std::sqrt(blur.xx - slant * blur.xy);
  double sum = 0.0;
  for (const Node& node : nodes) {
    const double turn = kPi * node.at, half = radius * std::cos(turn), off = radius * std::sin(turn) - y;
    const double row = gaussian_density(off / blur.sigma_y) / blur.sigma_y * half * kPi * node.weight;
    const double middle = x + slant * off;
    sum += row * (gaussian_below((half - middle) / own) - gaussian_below((-half - middle) / own));
  }
  return sum;
}

}  // namespace

double seen_disc(double x, double y, double radius, const Blur& blur) {
  if (radius < kSmallDisc * std::max(blur.sigma_x, blur.sigma_y)) return seen_small_disc(x, y, radius, blur);
  const double r = std::hypot(x, y), distance = r - radius;
  if (r == 0.0) return 1.0;
  const double nx = x / r, ny = y / r;
  const double normal = nx * nx * blur.xx + 2.0 * nx * ny * blur.xy + ny * ny * blur.yy;
  const double sigma = std::sqrt(normal), d = distance / sigma;
  if (d > kGaussianReach) return 0.0;
  if (d < -kGaussianReach) return 1.0;
  // At a tangential offset t the rim has a normal offset of -t^2 / 2R. t2 is the mean of t^2 on the rim.
  const double cross = nx * ny * (blur.yy - blur.xx) + (nx * nx - ny * ny) * blur.xy;
  const double tangential = ny * ny * blur.xx - 2.0 * nx * ny * blur.xy + nx * nx * blur.yy;
  const double slant = cross / normal;
  const double t2 = tangential - slant * cross + slant * slant * distance * distance;
  return gaussian_below(-d) - gaussian_density(d) / sigma * t2 / (2.0 * radius);
}

PrintedGrating::PrintedGrating(const Grating& grating, bool inverted, const Ink& ink)
    : grating_(grating), inverted_(inverted) {
  const double p = grating.pitch_mm, x = 0.5 * grating.width_mm, y = 0.5 * grating.height_mm;
  // An inverted grating has its ink between the lines.
  const double gain = inverted ? -ink.gain_mm : ink.gain_mm;
  const double dark = 0.5 * p * ink.line_share + gain, light = 0.5 * p - dark;
  dot_radius_ = dark;
  extent_x_ = Stripes::box(x);
  extent_y_ = Stripes::box(y);
  dark_x_ = Stripes(p, dark, 0.0, x);
  dark_y_ = Stripes(p, dark, 0.0, y);
  light_x_ = Stripes(p, light, 0.5, x);
  light_y_ = Stripes(p, light, 0.5, y);
}

double PrintedGrating::ink_uncorrelated(double x, double y, double sigma_x, double sigma_y) const {
  const double inside = extent_x_.seen(x, sigma_x) * extent_y_.seen(y, sigma_y);
  if (inside == 0.0) return 0.0;
  double ink = 0.0;
  switch (grating_.pattern) {
    case Pattern::kSquares:
      ink = dark_x_.seen(x, sigma_x) * dark_y_.seen(y, sigma_y);
      break;
    case Pattern::kLinesX:
      ink = dark_x_.seen(x, sigma_x) * extent_y_.seen(y, sigma_y);
      break;
    case Pattern::kLinesY:
      ink = extent_x_.seen(x, sigma_x) * dark_y_.seen(y, sigma_y);
      break;
    case Pattern::kCheckerboard:
      ink = dark_x_.seen(x, sigma_x) * dark_y_.seen(y, sigma_y) + light_x_.seen(x, sigma_x) * light_y_.seen(y, sigma_y);
      break;
    default:
      ink = inside - light_x_.seen(x, sigma_x) * light_y_.seen(y, sigma_y);
      break;
  }
  return inverted_ ? inside - ink : ink;
}

double PrintedGrating::cosine_ink(double x, double y, const Blur& blur) const {
  const double k = kTwoPi / grating_.pitch_mm;
  const double inside = extent_x_.seen(x, blur.sigma_x) * extent_y_.seen(y, blur.sigma_y);
  const double wave_x = std::exp(-0.5 * k * k * blur.xx) * std::cos(k * x);
  const double wave_y = std::exp(-0.5 * k * k * blur.yy) * std::cos(k * y);
  const double sign = inverted_ ? 1.0 : -1.0;  // crests are light unless inverted
  return inside * (0.5 + sign * 0.25 * (wave_x + wave_y));
}

// Returns the offset from the nearest dot. The pattern ends with its last whole dot.
double PrintedGrating::offset_from_dot(double at, double size_mm) const {
  const double p = grating_.pitch_mm, last = std::floor((0.5 * size_mm - dot_radius_) / p + 1e-9);
  return at - p * std::clamp(std::round(at / p), -last, last);
}

double PrintedGrating::dots_ink(double x, double y, const Blur& blur) const {
  const double p = grating_.pitch_mm, radius = dot_radius_;
  const double dx = offset_from_dot(x, grating_.width_mm), dy = offset_from_dot(y, grating_.height_mm);
  // The blur may reach the rims of neighbouring dots. Dots beyond the last whole one do not exist.
  const double reach = radius + kGaussianReach * std::max(blur.sigma_x, blur.sigma_y);
  const auto is_beyond_last = [&](double at, double size_mm) {
    return std::abs(offset_from_dot(at, size_mm)) > 0.5 * p;
  };
  double dot = 0.0;
  for (const int j : {-1, 0, 1}) {
    if (std::abs(dy - j * p) > reach || is_beyond_last(y - dy + j * p, grating_.height_mm)) continue;
    for (const int i : {-1, 0, 1}) {
      if (std::abs(dx - i * p) > reach || is_beyond_last(x - dx + i * p, grating_.width_mm)) continue;
      dot += seen_disc(dx - i * p, dy - j * p, radius, blur);
    }
  }
  if (!inverted_) return dot;
  return extent_x_.seen(x, blur.sigma_x) * extent_y_.seen(y, blur.sigma_y) - dot;
}

double PrintedGrating::ink(double x, double y, const Blur& blur) const {
  if (grating_.pattern == Pattern::kCosine) return cosine_ink(x, y, blur);
  if (grating_.pattern == Pattern::kDots) return dots_ink(x, y, blur);
  const double sigma_x = blur.sigma_x, sigma_y = blur.sigma_y;
  const double correlation = blur.xy / (sigma_x * sigma_y);
  const bool is_corner = !is_even_x(x, sigma_x * kGaussianReach) && !is_even_y(y, sigma_y * kGaussianReach);
  if (std::abs(correlation) < 1e-4 || !is_corner) return ink_uncorrelated(x, y, sigma_x, sigma_y);
  // Correlated Gaussians x and y are independent ones plus a shared third. The sum averages over the shared one.
  const double shared = std::sqrt(std::abs(correlation)), own = std::sqrt(1.0 - std::abs(correlation));
  const double step_x = shared * sigma_x, step_y = std::copysign(shared, correlation) * sigma_y;
  double sum = 0.0;
  for (const Node& node : gauss_hermite(std::abs(correlation))) {
    sum += node.weight * ink_uncorrelated(x + node.at * step_x, y + node.at * step_y, own * sigma_x, own * sigma_y);
  }
  return sum;
}

bool PrintedGrating::is_even_x(double x, double distance) const {
  if (grating_.pattern == Pattern::kLinesY) return extent_x_.is_even(x, distance);
  return dark_x_.is_even(x, distance) && light_x_.is_even(x, distance);
}

bool PrintedGrating::is_even_y(double y, double distance) const {
  if (grating_.pattern == Pattern::kLinesX) return extent_y_.is_even(y, distance);
  return dark_y_.is_even(y, distance) && light_y_.is_even(y, distance);
}

bool PrintedGrating::is_even(double x, double y, double distance) const {
  if (std::abs(x) > 0.5 * grating_.width_mm + distance || std::abs(y) > 0.5 * grating_.height_mm + distance)
    return true;
  if (grating_.pattern == Pattern::kCosine) return false;
  if (grating_.pattern == Pattern::kDots) {
    const double r = std::hypot(offset_from_dot(x, grating_.width_mm), offset_from_dot(y, grating_.height_mm));
    return std::abs(r - dot_radius_) > distance && extent_x_.is_even(x, distance) && extent_y_.is_even(y, distance);
  }
  return is_even_x(x, distance) && is_even_y(y, distance);
}

}  // namespace moiregauge::internal::simulator
