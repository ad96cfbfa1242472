// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "moiregauge/simulator/rendering/print.h"
#include "moiregauge/simulator/rendering/projection.h"
#include "moiregauge/simulator/rendering/texture.h"

namespace moiregauge::internal::simulator {

PrintedMarker::PrintedMarker(const SceneMarker& marker, double fold_mm, std::uint64_t seed)
    : crease_mm_(centre_of(marker.print).x), fold_mm_(fold_mm), ink_(marker.ink), ink_seed_(seed) {
  double x0 = 1e9, x1 = -1e9, y0 = 1e9, y1 = -1e9;
  const auto cover = [&](BoardPoint centre, double half_x, double half_y) {
    x0 = std::min(x0, centre.x - half_x);
    x1 = std::max(x1, centre.x + half_x);
    y0 = std::min(y0, centre.y - half_y);
    y1 = std::max(y1, centre.y + half_y);
  };
  if (marker.print.circle) {
    circle_ = *marker.print.circle;
    cover(circle_.centre, 0.5 * circle_.diameter_mm, 0.5 * circle_.diameter_mm);
  }
  if (marker.print.grating) {
    where_ = *marker.print.grating;
    grating_.emplace_back(where_, marker.inverted, marker.ink);
    cos_ = std::cos(where_.angle_rad);
    sin_ = std::sin(where_.angle_rad);
    const double c = std::abs(cos_), s = std::abs(sin_);
    cover(where_.centre, 0.5 * (c * where_.width_mm + s * where_.height_mm),
          0.5 * (s * where_.width_mm + c * where_.height_mm));
  }
  const double margin = marker.paper_margin_mm;
  low_ = {x0 - margin, y0 - margin};
  high_ = {x1 + margin, y1 + margin};
  paper_x_ = Stripes::box(0.5 * (high_.x - low_.x));
  paper_y_ = Stripes::box(0.5 * (high_.y - low_.y));
}

PrintedMarker::PrintedMarker(BoardPoint low, BoardPoint high)
    : low_(low),
      high_(high),
      paper_x_(Stripes::box(0.5 * (high.x - low.x))),
      paper_y_(Stripes::box(0.5 * (high.y - low.y))) {}

namespace {

// Returns the mean of `at(x, y)` over the cells of a pixel; its value at the centre if the area is uniform.
template <typename At>
double mean_over(const Footprint& pixel, bool is_even, const At& at) {
  if (is_even) return at(pixel.centre.x, pixel.centre.y);
  const double step = 1.0 / pixel.cells;
  double sum = 0.0;
  for (int j = 0; j < pixel.cells; ++j) {
    const double v = (j + 0.5) * step - 0.5;
    for (int i = 0; i < pixel.cells; ++i) {
      const double u = (i + 0.5) * step - 0.5;
      sum += at(pixel.centre.x + pixel.xu * u + pixel.xv * v, pixel.centre.y + pixel.yu * u + pixel.yv * v);
    }
  }
  return sum * step * step;
}

}  // namespace

double PrintedMarker::seen_paper(const Footprint& pixel, const Blur& blur) const {
  const double x0 = 0.5 * (low_.x + high_.x), y0 = 0.5 * (low_.y + high_.y);
  const bool is_even =
      paper_x_.is_even(pixel.centre.x - x0, pixel.reach_mm) && paper_y_.is_even(pixel.centre.y - y0, pixel.reach_mm);
  return mean_over(pixel, is_even, [&](double x, double y) {
    return paper_x_.seen(x - x0, blur.sigma_x) * paper_y_.seen(y - y0, blur.sigma_y);
  });
}

double PrintedMarker::seen_circle(const Footprint& pixel, const Blur& blur) const {
  const BoardPoint c = circle_.centre;
  const double radius = 0.5 * circle_.diameter_mm, dx = unfolded(pixel.centre.x) - c.x, dy = pixel.centre.y - c.y;
  const double outer = radius + pixel.reach_mm, inner = radius - pixel.reach_mm, r2 = dx * dx + dy * dy;
  if (r2 > outer * outer) return 0.0;
  if (inner > 0.0 && r2 < inner * inner) return 1.0;
  return mean_over(pixel, false,
                   [&](double x, double y) { return seen_disc(unfolded(x) - c.x, y - c.y, radius, blur); });
}

namespace {
constexpr double kMaxGrain = 2.4;  // largest absolute value of `grain`
}

BoardPoint PrintedMarker::smoothed(BoardPoint own) const {
  if (ink_.rough_mm == 0.0) return own;
  const double x = own.x / ink_.rough_length_mm, y = own.y / ink_.rough_length_mm;
  return {own.x + ink_.rough_mm * grain(ink_seed_, x, y), own.y + ink_.rough_mm * grain(ink_seed_ + 1, x, y)};
}

double PrintedMarker::seen_grating(const Footprint& pixel, const Blur& blur) const {
  const PrintedGrating& grating = grating_.front();
  const double c = cos_, s = sin_;
  const auto in_own_axes = [&](double x, double y) {
    return BoardPoint{c * (x - where_.centre.x) + s * (y - where_.centre.y),
                      -s * (x - where_.centre.x) + c * (y - where_.centre.y)};
  };
  const BoardPoint own_centre = in_own_axes(unfolded(pixel.centre.x), pixel.centre.y);
  const bool is_creased = fold_mm_ != 0.0 && std::abs(pixel.centre.x - crease_mm_) < pixel.reach_mm;
  const double reach_mm = pixel.reach_mm + kMaxGrain * ink_.rough_mm;
  const bool is_even = !is_creased && grating.is_even(own_centre.x, own_centre.y, reach_mm);
  const Blur own_blur(c * c * blur.xx + 2.0 * c * s * blur.xy + s * s * blur.yy,
                      c * s * (blur.yy - blur.xx) + (c * c - s * s) * blur.xy,
                      s * s * blur.xx - 2.0 * c * s * blur.xy + c * c * blur.yy);
  return mean_over(pixel, is_even, [&](double x, double y) {
    const BoardPoint own = smoothed(in_own_axes(unfolded(x), y));
    return grating.ink(own.x, own.y, own_blur);
  });
}

Seen PrintedMarker::seen(const Footprint& pixel, const Blur& blur) const {
  Seen seen;
  seen.paper = seen_paper(pixel, blur);
  if (seen.paper == 0.0) return seen;
  if (circle_.diameter_mm > 0.0) seen.ink += seen_circle(pixel, blur);
  if (!grating_.empty()) seen.ink += seen_grating(pixel, blur);
  return seen;
}

}  // namespace moiregauge::internal::simulator
