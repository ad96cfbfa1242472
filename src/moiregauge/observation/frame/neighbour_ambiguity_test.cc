// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/frame/neighbour_ambiguity.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

constexpr double kPitch = 10.0;                      // mm
constexpr Extent<frame::Board> kNeighbour{40.0, 0};  // mm, from the first target to the second

// Two targets, the second of another pitch and size by a factor. The first was read at the second's position, and the
// second at its own.
Observation read_at_its_neighbour(Reference& reference, Prediction& prediction, double factor) {
  Observation seen;
  for (const double scale : {1.0, factor}) {
    Marker marker;
    marker.role = Role::kTarget;
    marker.grating.emplace();
    marker.grating->centre = reference.site.markers.empty() ? BoardPoint{0, 0} : BoardPoint{0, 0} + kNeighbour;
    marker.grating->pitch_mm = scale * kPitch;
    marker.grating->width_mm = marker.grating->height_mm = scale * 30.0;
    reference.site.markers.push_back(marker);
    RasterPlan plan;
    plan.pitch_mm = scale * kPitch;
    reference.plans.push_back(plan);
    MarkerObservation at_rest;
    at_rest.loss = Loss::kNone;
    at_rest.order = Order::kProven;
    at_rest.patch.valid = true;
    reference.seen.markers.push_back(at_rest);
  }
  prediction.travel.resize(2);
  seen = reference.seen;
  seen.markers[0].window_shift = kNeighbour;
  seen.markers[0].points.emplace();
  return seen;
}

TEST(NeighbourAmbiguity, ATargetReadAtASimilarNeighbourIsContradicted) {
  for (const double factor : {1.0, 0.9, 1.1}) {
    Reference reference;
    Prediction prediction;
    Observation seen = read_at_its_neighbour(reference, prediction, factor);
    flag_ambiguous_targets(reference, prediction, seen);
    EXPECT_EQ(seen.markers[0].order, Order::kContradicted) << factor;
    EXPECT_FALSE(seen.markers[0].points) << factor;
    EXPECT_EQ(seen.markers[1].order, Order::kProven) << factor;
  }
}

TEST(NeighbourAmbiguity, ANeighbourOfHalfTheSizeIsNoOther) {
  Reference reference;
  Prediction prediction;
  Observation seen = read_at_its_neighbour(reference, prediction, 0.5);
  flag_ambiguous_targets(reference, prediction, seen);
  EXPECT_EQ(seen.markers[0].order, Order::kProven);
}

}  // namespace
}  // namespace moiregauge::internal
