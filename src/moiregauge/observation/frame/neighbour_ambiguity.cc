// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/frame/neighbour_ambiguity.h"

#include <algorithm>
#include <cmath>

namespace moiregauge::internal {
namespace {

// Largest relative difference between pitches and sizes of similar gratings. Chosen.
constexpr double kLike = 0.25;
// Share of the distance to a similar marker's last position. Chosen.
constexpr double kOwn = 0.5;
// Pitches. A target that moved by less is at its own position. Chosen.
constexpr double kStirs = 0.5;

bool is_near(double a, double b) { return std::abs(a - b) < kLike * std::max(a, b); }

bool look_alike(const Grating& a, const Grating& b) {
  return is_near(a.pitch_mm, b.pitch_mm) && is_near(a.width_mm, b.width_mm) && is_near(a.height_mm, b.height_mm);
}

Extent<frame::Board> travel_of(const Site& site, std::size_t i, const Prediction& prediction) {
  const bool travels = site.markers[i].role == Role::kTarget && i < prediction.travel.size();
  return travels ? prediction.travel[i] : Extent<frame::Board>{};
}

// Returns the displacement of a grating from the site's position, mm. An axis without a reading has the window's.
Extent<frame::Board> measured_travel(const Reference& reference, const MarkerObservation& seen, std::size_t i) {
  const auto d = displacement_at(reference.plans[i], reference.seen.markers[i].patch, seen.patch, seen.window_shift);
  return {std::isnan(d.x) ? seen.window_shift.x : d.x, std::isnan(d.y) ? seen.window_shift.y : d.y};
}

}  // namespace

void flag_ambiguous_targets(const Reference& reference, const Prediction& prediction, Observation& seen) {
  const Site& site = reference.site;
  for (std::size_t i = 0; i < seen.markers.size(); ++i) {
    MarkerObservation& here = seen.markers[i];
    const auto& own = site.markers[i].grating;
    if (site.markers[i].role != Role::kTarget || !own || here.loss != Loss::kNone) continue;
    const auto last = travel_of(site, i, prediction), now = measured_travel(reference, here, i);
    const double went = length(now - last);
    if (went < kStirs * own->pitch_mm) continue;
    for (std::size_t j = 0; j < site.markers.size(); ++j) {
      const auto& other = site.markers[j].grating;
      if (j == i || !other || !look_alike(*own, *other)) continue;
      const auto apart = own->centre + now - (other->centre + travel_of(site, j, prediction));
      if (went < kOwn * length(apart)) continue;
      here.order = Order::kContradicted;
      here.window_shift = last;
      here.points.reset();
      break;
    }
  }
}

}  // namespace moiregauge::internal
