// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/follower.h"

namespace moiregauge::internal {
namespace {

// Returns true if the outline contradicts the phase: the reading may be of another grating. Its position could drift by
// up to half a pitch per frame. The target is then searched at its last certain position.
bool has_left_its_outline(const Reference& reference, const MarkerObservation& seen, std::size_t i) {
  const bool has_outline = i < reference.prints.size() && reference.prints[i] && reference.prints[i]->outline;
  return has_outline && seen.order == Order::kContradicted;
}

}  // namespace

Follower::Follower(const Reference& reference) {
  prediction_.view = reference.seen.stage1;
  prediction_.travel.resize(reference.site.markers.size());
  expect(prediction_.travel, prediction_.view);
}

void Follower::expect(const std::vector<Extent<frame::Board>>& last_travel,
                      const std::optional<IdealFromBoard>& last_view) {
  prediction_.expected = prediction_.view;
  if (prediction_.view && last_view)
    prediction_.expected = *prediction_.view * (last_view->inverse() * *prediction_.view);
  prediction_.travel_expected.resize(last_travel.size());
  for (std::size_t i = 0; i < last_travel.size(); ++i)
    prediction_.travel_expected[i] = prediction_.travel[i] + (prediction_.travel[i] + (-1.0) * last_travel[i]);
}

std::vector<Extent<frame::Board>> Follower::follow(const Reference& reference, const Observation& observation) {
  std::vector<Extent<frame::Board>> travel(reference.site.markers.size(), {kNotMeasured, kNotMeasured});
  const auto last_view = prediction_.view;
  const auto last_travel = prediction_.travel;
  // A frame without references is lost. The next one goes through detection.
  prediction_.view = observation.references_seen ? std::optional(observation.stage1) : std::nullopt;
  if (!observation.references_seen) {
    expect(last_travel, std::nullopt);
    return travel;
  }
  for (std::size_t i = 0; i < travel.size(); ++i) {
    const MarkerObservation& seen = observation.markers[i];
    if (!reference.site.markers[i].grating || seen.loss != Loss::kNone) continue;
    const RasterPlan& plan = reference.plans[i];
    // The window is at the target's last position, or at this frame's first reading. The phase gives the rest within
    // half a pitch.
    travel[i] = displacement_at(plan, reference.seen.markers[i].patch, seen.patch, seen.window_shift);
    if (has_left_its_outline(reference, seen, i)) continue;
    prediction_.travel[i] = {or_zero(travel[i].x), or_zero(travel[i].y)};
  }
  expect(last_travel, last_view);
  return travel;
}

}  // namespace moiregauge::internal
