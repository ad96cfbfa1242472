// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/camera_claim.h"

#include <gtest/gtest.h>

#include "moiregauge/calibration/scene/footage_for_tests.h"

namespace moiregauge::internal {
namespace {

using test::Footage, test::footage_of, test::kFootageSeed, test::lens, test::Recording, test::swinging;

// Returns the contradiction of a camera whose k1 is stated as `k1`, to 1e-4.
std::optional<CameraContradiction> contradiction_of(double k1) {
  const Recording truth{.camera = lens(-0.0225), .angles = swinging(4.0)};
  const Footage run = footage_of(truth, 12);
  Camera stated = truth.camera;
  stated.k1 = k1;
  ScenePrior given = scene_prior(truth.site, stated.width, stated.height, stated);
  given.u_camera[3] = 1e-4;
  return camera_contradiction(truth.site, run.frames, given, calibrate(truth.site, run.frames, given));
}

// A distortion stated a third too large makes displacements wrong by several u. The fall of chi2 that shows it is far
// below that of a grossly wrong camera.
TEST(CameraClaim, AModeratelyWrongDistortionIsContradicted) {
  EXPECT_FALSE(contradiction_of(-0.0225)) << "seed " << kFootageSeed;
  const auto found = contradiction_of(-0.030);
  ASSERT_TRUE(found) << "seed " << kFootageSeed;
  EXPECT_GT(found->error_u, 2.0);
  EXPECT_EQ(found->parameter, 3U) << "k1";
}

}  // namespace
}  // namespace moiregauge::internal
