// SPDX-License-Identifier: Apache-2.0
// Tests solve_conventional and solve_two_stage on readings of one frame.
#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/displacement/five_markers_for_tests.h"
#include "moiregauge/displacement/method.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using test::kMmPerPx, test::kPhase_rad, test::kPitch_mm;

constexpr std::size_t kTarget = 4;

// A reference frame and one frame after it. Nothing moves on the board.
struct TwoFrames {
  Reference reference = test::five_markers(Pattern::kGrid);
  Observation now;
  TwoFrames() {
    reference.width = 2000, reference.height = 400;
    reference.seen.stage1 = reference.seen.stage2 = reference.view.ideal_from_board;
    now = reference.seen;
    now.frame = 1;
    now.references_seen = true;
  }
  // The camera travels parallel to the board, by `mm` on it.
  void travel(double mm) {
    Matrix3 shift = Matrix3::Identity();
    shift(0, 2) = mm / kMmPerPx;
    now.stage1 = now.stage2 = IdealFromBoard(shift * reference.view.ideal_from_board.matrix());
  }
  // The target looks larger than the references by this ratio, with this standard uncertainty.
  void look_larger(double ratio, double u) {
    for (Observation* frame : {&reference.seen, &now}) {
      frame->markers[kTarget].patch.gradient = {{{ratio, 0.0}, {0.0, ratio}}};
      frame->markers[kTarget].patch.u_gradient = u;
    }
  }
  [[nodiscard]] Sample solved_by(const char* method) const {
    return method_named(method)->solve(reference, {now}, {}).samples.at(0);
  }
};

// The phase of a reference differs from that of the reference frame by noise: sqrt(2) u. A movement of ten times that
// is the camera's, and moves every target.
TEST(Conventional, AReferenceThatMovesBeyondItsNoiseShowsThatTheCameraMoved) {
  for (const std::size_t axis : {0U, 1U}) {
    TwoFrames frames;
    frames.now.markers[0].patch.phase_rad[axis] = std::sqrt(2.0) * kPhase_rad;
    EXPECT_EQ(frames.solved_by("conventional").status, Status::kOk);
    frames.now.markers[0].patch.phase_rad[axis] = 10.0 * std::sqrt(2.0) * kPhase_rad;
    EXPECT_EQ(frames.solved_by("conventional").status, Status::kCameraMoved);
  }
}

// A target that looks 2 % larger is nearer by 2 % of the distance. While the camera travels by 50 mm on the board it
// seems to move by 1 mm. Four references do not show that, so u includes it. It is 30 times the noise, of which most is
// that of the references along x, so the row cannot be trusted.
TEST(TwoStage, ATargetOffThePlaneIsUntrustedOnceTheCameraTravels) {
  TwoFrames frames;
  frames.look_larger(0.02, 1e-4);
  EXPECT_EQ(frames.solved_by("two-stage").status, Status::kOk) << "the camera is fixed";
  frames.travel(50.0);
  const Sample sample = frames.solved_by("two-stage");
  EXPECT_NEAR(sample.budget.model.x, 0.02 * 50.0, 0.1);
  EXPECT_EQ(sample.status, Status::kUntrusted);
}

// References known to a millimetre make a target look larger by 0.3 %, and noise may add twice its u.
TEST(TwoStage, ATargetThatLooksLargerWithinItsNoiseIsOnThePlane) {
  TwoFrames frames;
  frames.look_larger(0.003 + 2.0 * 1e-3, 1e-3);
  frames.travel(50.0);
  const Sample sample = frames.solved_by("two-stage");
  EXPECT_LT(sample.budget.model.x, 0.1 * 0.005 * 50.0) << "a tenth of the parallax";
  EXPECT_EQ(sample.status, Status::kOk);
}

}  // namespace
}  // namespace moiregauge::internal
