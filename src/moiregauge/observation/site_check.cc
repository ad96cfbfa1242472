// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/site_check.h"

#include <cmath>
#include <cstdio>

#include "moiregauge/observation/reference.h"

namespace moiregauge {
namespace {

// The pitch that the picture shows, by the scale of the circle spacing: the phase gradient beyond the nominal carrier.
// A displacement gradient g along its own axis means the print is stretched by g against the board.
std::optional<std::string> pitch_disagreement(const Reference& reference, std::size_t i) {
  const Marker& marker = reference.site.markers[i];
  const PatchReading& patch = reference.seen.markers[i].patch;
  double stretch = 0.0;
  int axes = 0;
  for (std::size_t a = 0; a < 2; ++a) {
    if (std::isnan(patch.phase_rad[a]) || std::isnan(patch.gradient[a][a])) continue;
    stretch += patch.gradient[a][a];
    ++axes;
  }
  if (axes == 0) return std::nullopt;
  stretch /= axes;
  // A region of a few pixels tells no scale: ask three times its noise, too.
  const double allowed = marker.role == Role::kTarget ? kTargetTolerance : kSiteTolerance;
  if (std::abs(stretch) <= allowed + 3.0 * patch.u_gradient || !std::isfinite(patch.u_gradient)) return std::nullopt;
  char text[240];
  std::snprintf(text, sizeof text,
                "pitch_mm = %.4g of marker '%s' disagrees with the spacing of the reference circles, by which it is %.4g mm",
                marker.grating->pitch_mm, marker.name.c_str(), marker.grating->pitch_mm * (1.0 + stretch));
  return text;
}

std::optional<std::string> diameter_disagreement(const Reference& reference, std::size_t i) {
  const Marker& marker = reference.site.markers[i];
  const auto& seen = reference.seen.markers[i].circle;
  if (!seen || !marker.circle || marker.circle->diameter_mm <= 0.0) return std::nullopt;
  const double mm_per_px = reference.view.mm_per_px(marker.circle->centre);
  const double difference_px = seen->diameter_px - marker.circle->diameter_mm / mm_per_px;
  if (std::abs(difference_px) <= kDiameterTolerance) return std::nullopt;
  if (std::abs(difference_px) * mm_per_px <= kSiteTolerance * marker.circle->diameter_mm) return std::nullopt;
  char text[240];
  std::snprintf(text, sizeof text,
                "circle_diameter_mm = %.4g of marker '%s' disagrees with the spacing of the reference circles, by which it "
                "is %.4g mm",
                marker.circle->diameter_mm, marker.name.c_str(), seen->diameter_px * mm_per_px);
  return text;
}

}  // namespace

std::optional<std::string> site_disagreement(const Reference& reference) {
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    const Marker& marker = reference.site.markers[i];
    if (marker.grating && reference.seen.markers[i].patch.valid) {
      if (auto text = pitch_disagreement(reference, i)) return text;
    }
    if (auto text = diameter_disagreement(reference, i)) return text;
  }
  return std::nullopt;
}

}  // namespace moiregauge
