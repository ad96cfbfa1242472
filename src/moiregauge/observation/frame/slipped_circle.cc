// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/frame/slipped_circle.h"

#include <cmath>
#include <limits>

namespace moiregauge::internal {
namespace {

// Limit of the circles' rms deviation from a homography since the reference frame, px. A lens of -2 % can cause as
// much, but then no single circle explains it. Chosen.
constexpr double kSlip_px = 0.5;
constexpr double kSlipExplains = 0.25;  // largest share of that rms that may remain without the circle; chosen

double circle_residual_px(const std::vector<CirclePoint>& points) {
  const auto view = fit_circles(points);
  if (!view) return std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (const CirclePoint& p : points) sum += std::pow(length((*view)(p.board) - p.ideal), 2);
  return std::sqrt(sum / static_cast<double>(points.size()));
}

}  // namespace

std::optional<std::size_t> remove_slipped(const Reference& reference, std::vector<CirclePoint>& points) {
  if (points.size() < kMinReferencesForSlip) return std::nullopt;
  std::vector<CirclePoint> as_seen = points;
  for (CirclePoint& point : as_seen)
    point.board = reference.view.board(reference.seen.markers[point.marker].circle->centre);
  const double all = circle_residual_px(as_seen);
  if (!(all > kSlip_px)) return std::nullopt;
  double least = std::numeric_limits<double>::infinity();
  std::size_t slipped = 0;
  for (std::size_t k = 0; k < as_seen.size(); ++k) {
    std::vector<CirclePoint> others = as_seen;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    const double residual = circle_residual_px(others);
    if (residual < least) least = residual, slipped = k;
  }
  if (!(least < kSlipExplains * all)) return std::nullopt;
  const std::size_t marker = points[slipped].marker;
  points.erase(points.begin() + static_cast<std::ptrdiff_t>(slipped));
  return marker;
}

}  // namespace moiregauge::internal
