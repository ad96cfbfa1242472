// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/summary.h"

#include <cmath>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

Sample row_of(long frame, double y_mm, double u_mm, Status status) {
  Sample sample;
  sample.frame = frame;
  sample.displacement = {0.0, y_mm};
  sample.u = sample.budget.noise = {u_mm, u_mm};
  sample.status = status;
  return sample;
}

TargetSummary summary_of(const Samples& samples) {
  Reference reference;
  reference.site.markers.resize(1);
  reference.site.markers[0].role = Role::kTarget;
  return summarise(reference, samples).front();
}

// Peak to peak is that of the ok rows. A blurred row with a large u says nothing about them.
TEST(Summary, UncertaintyIsThatOfTheRowsWhoseMovementIsStated) {
  const TargetSummary summary = summary_of({row_of(0, 0.0, 0.0, Status::kOk), row_of(1, 1.0, 0.03, Status::kOk),
                                            row_of(2, 3.0, 0.04, Status::kOk), row_of(3, 9.0, 5.0, Status::kBlurred)});
  EXPECT_DOUBLE_EQ(summary.peak_to_peak().y, 3.0);
  EXPECT_DOUBLE_EQ(summary.u.y, std::sqrt((0.03 * 0.03 + 0.04 * 0.04) / 2.0));
  EXPECT_DOUBLE_EQ(summary.budget.noise.y, summary.u.y);
}

TEST(Summary, WithoutAnOkRowTheMeasuredRowsCount) {
  const TargetSummary summary = summary_of({row_of(0, 0.0, 0.0, Status::kOk), row_of(1, 9.0, 5.0, Status::kUntrusted)});
  EXPECT_DOUBLE_EQ(summary.u.y, 5.0);
}

}  // namespace
}  // namespace moiregauge::internal
