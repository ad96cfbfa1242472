// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/reference/packed_observation.h"

#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/observation/frame/observe.h"
#include "moiregauge/observation/reference/observations.h"
#include "moiregauge/simulator/scenario/built_in.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal {
namespace {

// Small rig: its reference frame and a frame after the camera has rotated by 0.4 deg.
struct PackedRig {
  Reference reference;
  Observation seen;

  PackedRig() {
    const auto scenario = simulator::built_in("small-1xyz").value();
    const auto first = render8(scenario, 0, {0, simulator::Area::kMarkersOnly});
    const auto later = render8(scenario, 60, {0, simulator::Area::kMarkersOnly});
    reference = make_reference({first.view(), 8}, simulator::site_of(scenario), Camera{}, {}).value();
    learn_prints({first.view(), 8}, reference);
    Prediction still;
    still.view = reference.seen.stage1;
    still.travel.resize(reference.site.markers.size());
    seen = observe_precise({later.view(), 8}, reference, still);
    seen.frame = 60;
    seen.time_s = 6.0;
  }
};

const PackedRig& packed_rig() {
  static const PackedRig rig;
  return rig;
}

TEST(PackedObservation, FiveMarkersTakeLessThanTwoKilobytes) {
  const PackedRig& rig = packed_rig();
  ASSERT_EQ(rig.seen.markers.size(), 5U);
  for (const MarkerObservation& marker : rig.seen.markers) ASSERT_TRUE(marker.points);
  EXPECT_LT(ObservationPacking(rig.reference).packed(rig.seen).size(), 1900U);
}

TEST(PackedObservation, RoundingIsBelowAThousandthOfU) {
  const PackedRig& rig = packed_rig();
  const ObservationPacking packing(rig.reference);
  const auto again = packing.unpacked(packing.packed(rig.seen));
  ASSERT_TRUE(again);
  EXPECT_EQ(again->frame, 60);
  EXPECT_EQ(again->time_s, 6.0);
  EXPECT_EQ(again->stage1.matrix(), rig.seen.stage1.matrix());
  EXPECT_EQ(again->stage2.matrix(), rig.seen.stage2.matrix());
  for (std::size_t i = 0; i < rig.seen.markers.size(); ++i) {
    const MarkerObservation &is = rig.seen.markers[i], &got = again->markers[i];
    EXPECT_EQ(got.circle.has_value(), is.circle.has_value());
    if (is.circle) {
      EXPECT_EQ(got.circle->centre.x, is.circle->centre.x);
      EXPECT_NEAR(got.circle->contrast, is.circle->contrast, 1e-6 * std::abs(is.circle->contrast));
    }
    EXPECT_EQ(got.window_shift.x, is.window_shift.x);
    EXPECT_EQ(got.loss, is.loss);
    EXPECT_EQ(got.order, is.order);
    for (const std::size_t a : {0U, 1U}) EXPECT_NEAR(got.patch.phase_rad[a], is.patch.phase_rad[a], 1.3e-7);
    // u of a grating is at least 5e-5 pitch, or 0.001 px.
    for (std::size_t n = 0; n < kPatchPoints; ++n) {
      EXPECT_LT(length(got.points->print[n] - is.points->print[n]), 5e-8);
      EXPECT_LT(length(got.points->image[n] - is.points->image[n]), 1e-8);
    }
    EXPECT_LT((got.points->information - is.points->information).norm(), 1e-6 * is.points->information.norm());
  }
}

// A resumed run unpacks and packs its frames once more than an uninterrupted one.
TEST(PackedObservation, ChangesNoValueTheSecondTime) {
  const PackedRig& rig = packed_rig();
  Observations once(rig.reference), twice(rig.reference), thrice(rig.reference);
  once.push_back(rig.seen);
  twice.push_back(once[0]);
  thrice.push_back(twice[0]);
  EXPECT_EQ(twice.packed(0), thrice.packed(0));
  for (std::size_t i = 0; i < rig.seen.markers.size(); ++i) {
    const PatchFit &a = *once[0].markers[i].points, &b = *twice[0].markers[i].points;
    EXPECT_EQ(a.information, b.information);
    for (std::size_t n = 0; n < kPatchPoints; ++n) {
      EXPECT_EQ(a.print[n].x, b.print[n].x);
      EXPECT_EQ(a.image[n].y, b.image[n].y);
    }
  }
}

// A partly covered grating has its own normal equations, in its own window.
TEST(PackedObservation, KeepsValuesThatDifferFromTheReferenceFrame) {
  const PackedRig& rig = packed_rig();
  Observation seen = rig.seen;
  PatchFit& fit = *seen.markers[0].points;
  fit.information(3, 3) *= 1.01;
  fit.image[4].x += 0.01;
  seen.markers[0].circle->contrast += 1.0;
  seen.markers[1].points.reset();
  seen.markers[1].loss = Loss::kCovered;
  seen.markers[2].quantiser = {kUnknownStep, true};
  seen.decode_error = true;
  seen.reference_problem = "found 3 of 4";
  for (const ObservationPacking& packing : {ObservationPacking(rig.reference), ObservationPacking()}) {
    const auto again = packing.unpacked(packing.packed(seen));
    ASSERT_TRUE(again);
    const PatchFit& got = *again->markers[0].points;
    EXPECT_LT((got.information - fit.information).norm(), 1e-7 * fit.information.norm());
    EXPECT_EQ(got.image[4].x, fit.image[4].x);
    EXPECT_LT(length(got.print[4] - fit.print[4]), 5e-8);
    EXPECT_NEAR(again->markers[0].circle->contrast, seen.markers[0].circle->contrast, 1e-5);
    EXPECT_FALSE(again->markers[1].points);
    EXPECT_EQ(again->markers[1].loss, Loss::kCovered);
    EXPECT_TRUE(std::isnan(again->markers[2].quantiser.step));
    EXPECT_TRUE(again->markers[2].quantiser.predicted);
    EXPECT_TRUE(again->decode_error);
    EXPECT_EQ(again->reference_problem, "found 3 of 4");
  }
}

TEST(PackedObservation, OtherBytesAreRefused) {
  const PackedRig& rig = packed_rig();
  const ObservationPacking packing(rig.reference);
  const std::string bytes = packing.packed(rig.seen);
  for (std::size_t size = 0; size < bytes.size(); ++size) ASSERT_FALSE(packing.unpacked(bytes.substr(0, size))) << size;
  EXPECT_FALSE(packing.unpacked(bytes + '\0'));
}

}  // namespace
}  // namespace moiregauge::internal
