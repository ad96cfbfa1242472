// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/reference_fault.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "moiregauge/calibration/scene/footage_for_tests.h"
#include "moiregauge/displacement/precise/reference_slip.h"

namespace moiregauge::internal {
namespace {

using test::Footage, test::footage_of, test::kFootageSeed, test::lens, test::Recording, test::rig_of_six,
    test::swinging;

constexpr SceneModel kRadialLens{.radial = true};

ScenePrior prior_of(const Recording& truth) {
  return scene_prior(truth.site, truth.camera.width, truth.camera.height, std::nullopt);
}

// A reference slips by 0.5 mm while frame 5 is exposed, in which it is read on its way. Without a position of its own,
// that frame would leave residuals of 0.2 mm, 300 u, and no step would seem to explain the footage.
TEST(ReferenceSlip, AFrameExposedDuringTheStepHasItsOwnPosition) {
  constexpr std::size_t kSlips = 1;
  const Recording truth{.site = rig_of_six(), .camera = lens(-0.0225), .angles = swinging(4.0)};
  const Footage run = footage_of(truth, 12, [](std::size_t marker, int frame) -> Extent<frame::Board> {
    return {0.0, marker != kSlips || frame < 5 ? 0.0 : frame == 5 ? 0.2 : 0.5};
  });
  const ScenePrior prior = prior_of(truth);
  const auto others = test::series_of(run.frames).without_marker(kSlips);
  std::vector<std::size_t> all{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  const Scene start = solve_bundle(truth.site, others.at(all), prior, kRadialLens).scene;
  ASSERT_TRUE(start.solved) << start.problem;
  const auto slip = fit_reference_step(truth.site, run.frames, prior, start, kSlips);
  ASSERT_TRUE(slip);
  EXPECT_EQ(slip->step.before, 4);
  EXPECT_EQ(slip->step.settled, 6);
  // Noise remains. The step and the frame have six unknowns.
  const double dof = static_cast<double>(slip->dof + slip->free_rows - 4);
  EXPECT_NEAR(slip->left() / dof, 1.0, 4.0 * std::sqrt(2.0 / dof) + 40.0 / dof) << "seed " << kFootageSeed;
}

// Two of six references are half a metre from a group of four. The group hardly determines the pose at that distance. A
// step of one of the two therefore looks almost like a step of its neighbour the other way. A step of 7 um lowers chi2
// by 94 with one of them free and by 92 with the other. The lead is 5, which other noise may reverse.
TEST(ReferenceFault, OneOfTwoNeighboursThatOnlyVerifyEachOtherIsNotNamed) {
  constexpr std::size_t kMoving = 1;
  Recording truth{.site = rig_of_six(), .camera = lens(-0.0225), .angles = swinging(4.0)};
  constexpr std::array<BoardPoint, 6> kAt{{{-340, 40}, {340, 22}, {-340, -40}, {340, -22}, {-250, -40}, {-250, 40}}};
  for (std::size_t k = 0; k < kAt.size(); ++k) truth.site.markers[k].grating->centre = kAt[k];
  const ScenePrior prior = prior_of(truth);
  const auto verdict_on = [&](double step_mm) {
    const Footage run = footage_of(truth, 16, [=](std::size_t marker, int frame) -> Extent<frame::Board> {
      return {0.0, marker == kMoving && frame >= 8 ? step_mm : 0.0};
    });
    const Scene start = solve_bundle(truth.site, run.frames, prior, kRadialLens).scene;
    return test_references(truth.site, test::series_of(run.frames), prior, start, false);
  };
  const ReferenceVerdict small = verdict_on(0.007);
  EXPECT_TRUE(small.doubtful) << "seed " << kFootageSeed;
  EXPECT_FALSE(small.moved) << "seed " << kFootageSeed;
  EXPECT_EQ(verdict_on(0.02).moved, kMoving) << "a lead of 55, seed " << kFootageSeed;
}

// A reference creeps by 0.5 mm over 24 frames. A step leaves residuals of up to 0.12 mm, 200 u. Free in every frame, it
// leaves noise, as no other reference does.
TEST(ReferenceFault, OneOfSixThatCreepsIsNamedWithoutAFrame) {
  constexpr std::size_t kCreeps = 1;
  const Recording truth{.site = rig_of_six(), .camera = lens(-0.0225), .angles = swinging(4.0)};
  const Footage run = footage_of(truth, 24, [](std::size_t marker, int frame) -> Extent<frame::Board> {
    return {0.0, marker == kCreeps ? 0.5 * frame / 23.0 : 0.0};
  });
  const ScenePrior prior = prior_of(truth);
  const Scene start = solve_bundle(truth.site, run.frames, prior, kRadialLens).scene;
  const ReferenceVerdict verdict = test_references(truth.site, test::series_of(run.frames), prior, start, false);
  EXPECT_EQ(verdict.moved, kCreeps) << "seed " << kFootageSeed;
  EXPECT_FALSE(verdict.doubtful) << "seed " << kFootageSeed;
  EXPECT_FALSE(verdict.step) << "frame " << verdict.step->settled;
}

// The reference frame comes first in the footage, whatever its number. A reference steps by 0.05 mm before that frame.
TEST(ReferenceFault, AStepBeforeTheReferenceFrameLiesBetweenTheFramesOfItsTime) {
  constexpr std::size_t kSteps = 1;
  constexpr int kReferenceFrame = 15, kStep = 10;
  const Recording truth{.site = rig_of_six(), .camera = lens(-0.0225), .angles = swinging(4.0)};
  Footage run = footage_of(truth, 24, [](std::size_t marker, int frame) -> Extent<frame::Board> {
    return {0.0, marker == kSteps && frame >= kStep ? 0.05 : 0.0};
  });
  std::rotate(run.frames.begin(), run.frames.begin() + kReferenceFrame, run.frames.begin() + kReferenceFrame + 1);
  const ScenePrior prior = prior_of(truth);
  const Scene start = solve_bundle(truth.site, run.frames, prior, kRadialLens).scene;
  const ReferenceVerdict verdict = test_references(truth.site, test::series_of(run.frames), prior, start, false);
  EXPECT_EQ(verdict.moved, kSteps) << "seed " << kFootageSeed;
  ASSERT_TRUE(verdict.step) << "seed " << kFootageSeed;
  EXPECT_EQ(verdict.step->before, kStep - 1);
  EXPECT_EQ(verdict.step->settled, kStep);
}

// Hot air moves the images of all markers independently, by 6 um in each frame, 10 u. A separate position in every frame
// lowers chi2 for each reference then. No reference moves, and u follows from the jitter of all.
TEST(ReferenceFault, HazeThatMovesAllReferencesIndependentlyIsNoFault) {
  const Recording truth{.site = rig_of_six(), .camera = lens(-0.0225), .angles = swinging(4.0)};
  const Footage run = footage_of(truth, 24, [](std::size_t marker, int frame) -> Extent<frame::Board> {
    std::mt19937_64 random(1000 * marker + static_cast<std::size_t>(frame) + 1);
    std::normal_distribution<double> haze(0.0, 0.006);
    const double x = haze(random);
    return {x, haze(random)};
  });
  const ScenePrior prior = prior_of(truth);
  const Scene start = solve_bundle(truth.site, run.frames, prior, kRadialLens).scene;
  const ReferenceVerdict verdict = test_references(truth.site, test::series_of(run.frames), prior, start, false);
  EXPECT_FALSE(verdict.moved) << "reference " << *verdict.moved << ", seed " << kFootageSeed;
  EXPECT_FALSE(verdict.doubtful) << "seed " << kFootageSeed;
}

}  // namespace
}  // namespace moiregauge::internal
