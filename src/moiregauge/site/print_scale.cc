// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/site/print_scale.h"

#include <algorithm>
#include <cmath>

namespace moiregauge::internal {

Site with_prints_scaled(Site site, PrintScale scale) {
  for (Marker& marker : site.markers) {
    if (marker.circle) marker.circle->diameter_mm *= scale.factor;
    if (!marker.grating) continue;
    Grating& grating = *marker.grating;
    grating.pitch_mm *= scale.factor;
    grating.width_mm *= scale.factor;
    grating.height_mm *= scale.factor;
    if (marker.circle) marker.circle->centre = grating.centre + scale.factor * (marker.circle->centre - grating.centre);
  }
  double& known = site.known_to.print_scale;
  known = scale.u > 0.0 ? std::hypot(scale.u, scale.spread) : std::max(known, scale.spread);
  return site;
}

Site with_places_scaled(Site site, double factor) {
  const auto scaled = [&](BoardPoint p) { return BoardPoint{factor * p.x, factor * p.y}; };
  for (Marker& marker : site.markers) {
    const BoardPoint old = marker.grating ? marker.grating->centre : BoardPoint{};
    if (marker.grating) marker.grating->centre = scaled(old);
    if (!marker.circle) continue;
    marker.circle->centre =
        marker.grating ? marker.grating->centre + (marker.circle->centre - old) : scaled(marker.circle->centre);
  }
  return site;
}

PrintScale mean_of_rulers(double along_x, double along_y) {
  return {0.5 * (along_x + along_y), 0.0, 0.5 * std::abs(along_x - along_y)};
}

}  // namespace moiregauge::internal
