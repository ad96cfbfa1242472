// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/frame/observe.h"

#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/observation/frame/small_rig_for_tests.h"
#include "moiregauge/observation/print/print_origin.h"

namespace moiregauge::internal {
namespace {

using test::as_at_rest, test::marker_of, test::SmallRig;

// Six references of the small rig. NE slips up and towards the camera after the reference frame.
simulator::Scenario slipped_by(double up_mm, double nearer_mm) {
  simulator::Scenario scenario = *simulator::built_in("small-six-slip");
  simulator::SceneMarker& slipped = marker_of(scenario, "NE");
  slipped.dy.knots = {{0.1, 0.0}, {0.11, up_mm}};
  slipped.dz.knots = {{0.1, 0.0}, {0.11, nearer_mm}};
  return scenario;
}

// The circle of 16 mm is then outside the layout. No other circle of its size is near, so it is identified, with its
// grating, and the user learns by how much the reference slipped. A sheet that comes 24 mm nearer looks 2 % larger.
TEST(Observe, AReferenceThatSlipsByMoreThanItsDiameterIsReadWhereItIs) {
  constexpr double kSlip = 20.0;  // mm
  for (const double nearer_mm : {0.0, 24.0}) {
    const SmallRig rig(slipped_by(kSlip, nearer_mm));
    const auto now = rig.picture(2);
    const std::size_t i = rig.index_of("NE");
    const Observation seen = observe_precise({now.view(), 8}, rig.reference, as_at_rest(rig.reference));
    ASSERT_TRUE(seen.references_seen) << seen.reference_problem;
    ASSERT_TRUE(seen.markers[i].circle) << nearer_mm;
    const auto there = project(rig.scenario, 2, *simulator::find_marker(rig.scenario, "NE"),
                               rig.reference.site.markers[i].circle->centre);
    EXPECT_LT(length(seen.markers[i].circle->centre - there), 0.5);
    if (nearer_mm > 0.0) continue;
    EXPECT_EQ(seen.markers[i].loss, Loss::kNone);
    ASSERT_TRUE(seen.markers[i].points);
    EXPECT_NEAR(seen.markers[i].window_shift.y, kSlip, 0.1);
  }
}

// A phase repeats with every pitch. A circle on the same sheet does not, and shows which pitch it is.
TEST(Observe, ACircleContradictsAReadingThatIsAWholePitchOff) {
  simulator::Scenario scenario = *simulator::built_in("small-1xyz");
  marker_of(scenario, "mid").print.circle = Circle{{0.0, 36.0}, 16.0};
  SmallRig rig(scenario);
  const std::size_t target = rig.index_of("mid");
  ASSERT_TRUE(rig.reference.prints[target]);
  rig.reference.prints[target]->outline.reset();
  const auto now = rig.picture(2);
  Prediction prediction = as_at_rest(rig.reference);
  prediction.view.reset(), prediction.expected.reset();
  const auto order = [&](double travel_mm) {
    prediction.travel[target] = {0.0, travel_mm};
    return observe_precise({now.view(), 8}, rig.reference, prediction).markers[target].order;
  };
  EXPECT_EQ(order(0.1), Order::kProven);
  EXPECT_EQ(order(0.1 - rig.reference.plans[target].pitch_mm), Order::kContradicted);
}

// Returns the distance of a template's origin from the symmetry point of its grating, pitches.
double off_its_symmetry(const PrintModel& model) {
  const auto origin = nearest_symmetry(model.print, true, true);
  return origin ? std::hypot(origin->at.x, origin->at.y) : std::nan("");
}

// The site states one grating 0.3 mm off its symmetry point. If it claims 0.3 mm, the grating itself shows the point
// that was surveyed. If it claims 1 mm, a tenth of the pitch, the stated position counts.
TEST(Observe, ASurveyedGratingHasItsOriginAtItsSymmetryPoint) {
  const simulator::Scenario scenario = *simulator::built_in("small-1xyz");
  for (const double u_mm : {0.3, 1.0}) {
    Site stated = simulator::site_of(scenario);
    stated.known_to.position_mm = u_mm;
    stated.markers[0].grating->centre.x += 0.3;
    const SmallRig rig(scenario, stated);
    ASSERT_TRUE(rig.reference.prints[0]);
    const double off = off_its_symmetry(*rig.reference.prints[0]);
    // Circles of 16 mm are read to 0.01 mm, and the pitch is 10 mm.
    if (u_mm < 0.5)
      EXPECT_LT(off, 0.002);
    else
      EXPECT_NEAR(off, 0.03, 0.004);
  }
}

}  // namespace
}  // namespace moiregauge::internal
