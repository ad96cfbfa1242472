// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/follower.h"

#include <cmath>

namespace moiregauge {
namespace {

double or_zero(double d) { return std::isnan(d) ? 0.0 : d; }

}  // namespace

Follower::Follower(const Reference& reference) {
  prediction_.view = reference.seen.stage1;
  prediction_.travel.resize(reference.site.markers.size());
}

std::vector<Extent<frame::Board>> Follower::follow(const Reference& reference, const Observation& observation) {
  std::vector<Extent<frame::Board>> travel(reference.site.markers.size(), {kNotMeasured, kNotMeasured});
  // A frame without its references is lost; the next one is looked for afresh.
  prediction_.view = observation.references_seen ? std::optional(observation.stage1) : std::nullopt;
  if (!observation.references_seen) return travel;
  for (std::size_t i = 0; i < travel.size(); ++i) {
    const MarkerObservation& seen = observation.markers[i];
    if (!reference.site.markers[i].grating || seen.loss != Loss::kNone) continue;
    const RasterPlan& plan = reference.plans[i];
    // The window already stands at the whole pitch nearest to the last travel; the phase gives the rest within half a
    // pitch of the window, which may be one turn away from the last travel: take the nearest one.
    const auto last = raster_from_board(plan, prediction_.travel[i]);
    const auto base = raster_from_board(plan, seen.window_shift);
    const auto rest = displacement_between(plan, reference.seen.markers[i].patch, seen.patch);
    if (std::isnan(rest.x) || std::isnan(rest.y)) {
      travel[i] = seen.window_shift + rest;
    } else {
      const auto within = raster_from_board(plan, rest);
      const auto nearest = [&](std::size_t a) {
        const double d = base[a] + within[a];
        return d + std::round((last[a] - d) / plan.pitch_mm) * plan.pitch_mm;
      };
      travel[i] = board_from_raster(plan, nearest(0), nearest(1));
    }
    prediction_.travel[i] = {or_zero(travel[i].x), or_zero(travel[i].y)};
  }
  return travel;
}

}  // namespace moiregauge
