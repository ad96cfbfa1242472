// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/precise_status.h"

#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/observation/frame/patch_of_points.h"

namespace moiregauge::internal {
namespace {

// A target with a noise of 1.5 grey levels and a contrast of 40, and a frame that fits it.
struct Frame {
  Reference reference;
  Observation seen;
  FrameFit fit;
  Frame() {
    reference.site.markers.resize(1);
    reference.site.markers[0].role = Role::kTarget;
    reference.prints.resize(1);
    reference.prints[0].emplace();
    reference.prints[0]->print = PrintTemplate::cosine(40.0, 40.0);
    PatchFit points;
    points.sigma = 1.5, points.gain = {1.0, 0.0, 0.0};
    MarkerObservation marker;
    marker.loss = Loss::kNone;
    marker.patch.modulation = {40.0, 40.0};
    marker.patch.clipped_share = 0.0;
    marker.points = points;
    marker.quantiser.step = 0.0;  // lossless
    reference.seen.markers = {marker};
    seen = reference.seen;
    seen.references_seen = true;
    fit.ok = true;
    fit.shift_row = {0};
    fit.dof = 80;
    fit.chi2_sum = 80.0;
  }
  [[nodiscard]] Status status() const { return precise_status(reference, seen, 0, fit, kUntrustedChi2); }
};

TEST(PreciseStatus, AFrameThatFitsIsOk) { EXPECT_EQ(Frame().status(), Status::kOk); }

// Displacements are stated with a coverage factor of 2, so a scatter of ten times u must never pass.
TEST(PreciseStatus, AFrameTenTimesItsUncertaintyOffTheSceneIsUntrusted) {
  Frame frame;
  frame.fit.chi2_sum = 100.0 * static_cast<double>(frame.fit.dof);
  EXPECT_EQ(frame.status(), Status::kUntrusted);
}

// A share s of hidden grating, in which the pixels miss the whole contrast, leaves a residual of sqrt(s) contrasts.
TEST(PreciseStatus, AGratingHiddenByATenthIsPartlyCovered) {
  Frame frame;
  frame.seen.markers[0].points->sigma = std::hypot(1.5, std::sqrt(0.1) * 40.0);
  EXPECT_EQ(frame.status(), Status::kPartlyCovered);
}

// Tracking, which has a short way for whole gratings, is stricter: it lets a fit with a hidden hundredth through, at most.
TEST(PreciseStatus, AGratingHiddenByATwentiethIsNotWhole) {
  const Frame frame;
  PatchFit points = *frame.seen.markers[0].points;
  EXPECT_TRUE(is_whole(points, *frame.reference.seen.markers[0].points, *frame.reference.prints[0], 0.0));
  points.sigma = std::hypot(1.5, std::sqrt(0.05) * 40.0);
  EXPECT_FALSE(is_whole(points, *frame.reference.seen.markers[0].points, *frame.reference.prints[0], 0.0));
}

// A motion of the width of half a pitch during exposure leaves 2 / pi of the fundamental, one of three quarters 0.3.
TEST(PreciseStatus, AFringeSmearedOverThreeQuartersOfAPitchIsBlurred) {
  for (const std::size_t axis : {0U, 1U}) {
    Frame frame;
    frame.seen.markers[0].patch.modulation[axis] *= 0.6366;
    EXPECT_EQ(frame.status(), Status::kOk);
    frame.seen.markers[0].patch.modulation[axis] = 0.3001 * 40.0;
    EXPECT_EQ(frame.status(), Status::kBlurred);
  }
}

// A tenth of a sine's period is within 5 % of its peak. Clipped there, the fundamental shrinks by 0.2 %, and an
// asymmetric light shifts it.
TEST(PreciseStatus, AFringeWithATenthOfItsPixelsClippedIsSaturated) {
  Frame frame;
  frame.seen.markers[0].patch.clipped_share = 0.1;
  EXPECT_EQ(frame.status(), Status::kSaturated);
  frame.reference.seen.markers[0].patch.clipped_share = 0.1;  // as in the reference frame, and in the template
  EXPECT_EQ(frame.status(), Status::kOk);
}

// Rows of one target, all at `u` = 0.01 mm. Height `height` is known to 0.1 mm and appears as a tenth of it.
struct Rows {
  Samples samples;
  std::vector<RowOutOfPlane> out_of_plane;
  std::vector<HeightSeries> heights{1};
  void add(double height_mm) {
    Sample sample;
    sample.status = Status::kOk;
    sample.u = {0.01, 0.01};
    const OutOfPlane moved{height_mm, 0.1, std::abs(height_mm) / 0.1, {0.1 * height_mm, 0.0}};
    if (may_matter(moved, sample)) out_of_plane.push_back({samples.size(), moved});
    samples.push_back(sample);
  }
};

// Chance gives 3 u in one of 400 rows. A target that moves out of the plane shows far more in some row. Then the scene's
// height is wrong for all rows.
TEST(PreciseStatus, ATargetThatMovesTowardsTheCameraIsUntrusted) {
  Site site;
  site.markers.resize(1);
  site.markers[0].name = "T1";
  Rows still, moving;
  for (int n = 0; n < 400; ++n) still.add(n == 100 ? 0.3 : 0.0), moving.add(n < 300 ? 0.0 : n == 300 ? 0.3 : -2.0);
  EXPECT_TRUE(distrust_out_of_plane(site, still.out_of_plane, still.heights, still.samples, true).empty());
  EXPECT_EQ(still.samples[100].status, Status::kOk);
  const auto notes = distrust_out_of_plane(site, moving.out_of_plane, moving.heights, moving.samples, true);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("'T1' moves away from the camera by at least 1.8 mm"), std::string::npos) << notes[0];
  EXPECT_EQ(moving.samples[299].status, Status::kUntrusted);
  EXPECT_EQ(moving.samples[300].status, Status::kUntrusted);
  EXPECT_EQ(moving.samples[399].status, Status::kUntrusted);
}

// Lengths in mm are in proportion to the focal length, so none is stated without it.
TEST(PreciseStatus, NoLengthIsStatedWithoutAFocalLength) {
  Site site;
  site.markers.resize(1);
  site.markers[0].name = "T1";
  Rows moving;
  for (int n = 0; n < 40; ++n) moving.add(n < 30 ? 0.0 : 2.0);
  const auto notes = distrust_out_of_plane(site, moving.out_of_plane, moving.heights, moving.samples, false);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("'T1' moves towards the camera"), std::string::npos) << notes[0];
  EXPECT_EQ(notes[0].find("mm"), std::string::npos) << notes[0];
  EXPECT_EQ(moving.samples[39].status, Status::kUntrusted);
}

}  // namespace
}  // namespace moiregauge::internal
