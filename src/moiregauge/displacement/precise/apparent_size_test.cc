// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/apparent_size.h"

#include <gtest/gtest.h>

#include "moiregauge/calibration/scene/footage_for_tests.h"

namespace moiregauge::internal {
namespace {

// A scene seen from 1200 mm, in which one reference came out larger than the site states.
std::vector<std::string> notes_on_a_reference_larger_by(double ratio) {
  const Site site = test::rig();
  Calibration calibration;
  calibration.prior = scene_prior(site, 4104, 1012, std::nullopt);
  Scene& scene = calibration.bundle.scene;
  scene.camera = test::lens(0.0);
  scene.markers = calibration.prior.markers;
  scene.markers[1].value[MarkerShape::kScale] = ratio;
  scene.covariance = Eigen::MatrixXd::Zero(scene_parameters(5), scene_parameters(5));
  FrameFit& fit = calibration.fits.emplace_back();
  fit.ok = true;
  fit.pose.shift = {0.0, 0.0, 1200.0};
  return apparent_size_notes(site, calibration, size_deviations(site, calibration));
}

// Print scales are known to 0.05 %, and heights to 3 mm of 1200 mm: 0.25 % together. A grating that looks 2 % larger, 8
// u, has another pitch or another height than stated, and displacements are wrong by 2 %.
TEST(ApparentSizeNotes, AReferenceEightUncertaintiesLargerIsReported) {
  EXPECT_TRUE(notes_on_a_reference_larger_by(0.005).empty());
  for (const double ratio : {0.02, -0.02}) {
    const auto notes = notes_on_a_reference_larger_by(ratio);
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_NE(notes[0].find(ratio > 0.0 ? "2 % larger" : "2 % smaller"), std::string::npos) << notes[0];
  }
}

}  // namespace
}  // namespace moiregauge::internal
