// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "moiregauge/simulator/print.h"

namespace moiregauge::simulator {

PrintedMarker::PrintedMarker(const SceneMarker& marker) {
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
    grating_.emplace_back(where_, marker.inverted);
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

Seen PrintedMarker::seen(BoardPoint point, const Blur& blur) const {
  const double px = point.x - 0.5 * (low_.x + high_.x), py = point.y - 0.5 * (low_.y + high_.y);
  Seen seen;
  seen.paper = paper_x_.seen(px, std::sqrt(blur.xx)) * paper_y_.seen(py, std::sqrt(blur.yy));
  if (seen.paper == 0.0) return seen;
  if (circle_.diameter_mm > 0.0) {
    seen.ink = seen_disc(point.x - circle_.centre.x, point.y - circle_.centre.y, 0.5 * circle_.diameter_mm, blur);
  }
  for (const PrintedGrating& grating : grating_) {
    const double x = point.x - where_.centre.x, y = point.y - where_.centre.y;
    const double c = cos_, s = sin_;
    const Blur own{c * c * blur.xx + 2.0 * c * s * blur.xy + s * s * blur.yy,
                   c * s * (blur.yy - blur.xx) + (c * c - s * s) * blur.xy,
                   s * s * blur.xx - 2.0 * c * s * blur.xy + c * c * blur.yy};
    seen.ink += grating.ink(c * x + s * y, -s * x + c * y, own);
  }
  return seen;
}

bool PrintedMarker::is_even(BoardPoint point, double distance) const {
  const double px = point.x - 0.5 * (low_.x + high_.x), py = point.y - 0.5 * (low_.y + high_.y);
  if (!paper_x_.is_even(px, distance) || !paper_y_.is_even(py, distance)) return false;
  if (circle_.diameter_mm > 0.0) {
    const double r = std::hypot(point.x - circle_.centre.x, point.y - circle_.centre.y);
    if (std::abs(r - 0.5 * circle_.diameter_mm) <= distance) return false;
  }
  const double x = point.x - where_.centre.x, y = point.y - where_.centre.y;
  for (const PrintedGrating& grating : grating_) {
    if (!grating.is_even(cos_ * x + sin_ * y, -sin_ * x + cos_ * y, distance)) return false;
  }
  return true;
}

}  // namespace moiregauge::simulator
