// SPDX-License-Identifier: Apache-2.0
// Tests a given camera (`--camera`) against the footage it is used for.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "moiregauge/calibration/model/calibrate.h"

namespace moiregauge::internal {

// Likelihood ratio of a stated prior and a wider one, with everything else free in both cases.
struct PriorRatio {
  double fall = 0.0;            // decrease of chi2 and priors with the wider prior
  double unit = 1.0;            // chi2 per degree of freedom with the wider prior, at least 1
  double error_u = 0.0;         // largest change of a displacement, in its u
  double solved_error_u = 0.0;  // the same for the scene as solved, whose model may be smaller
  BundleSolution open;          // with the wider prior
  Eigen::MatrixXd covariance;   // covariance of the open scene
};

// Compares both priors on up to 40 of the key frames and the extremes of the pose.
// Fails (nothing): one of the priors gives no scene.
[[nodiscard]] std::optional<PriorRatio> compare_priors(const Site& site, std::span<const BundleFrame> all,
                                                       const ScenePrior& stated, const ScenePrior& wider,
                                                       const Calibration& solved);

// A camera that the references contradict.
struct CameraContradiction {
  std::size_t parameter = 0;  // index in the scene's camera: the most deviating one
  double given = 0.0, u_given = 0.0;
  double shown = 0.0, u_shown = 0.0;  // from the footage without the statement
  double error_u = 0.0;               // largest change of a displacement, in its u
};

// Tests a given camera by a likelihood ratio: the fall of chi2 if the camera is unknown, with everything else free in
// both cases. Returns the contradiction if the fall exceeds chance and a displacement changes by more than its u.
// `given`: prior with the camera as stated.
// `frames`: key frames, the reference frame first, as in `solved`.
[[nodiscard]] std::optional<CameraContradiction> camera_contradiction(const Site& site,
                                                                      std::span<const BundleFrame> frames,
                                                                      const ScenePrior& given,
                                                                      const Calibration& solved);

// Returns the warning with the most deviating parameter.
[[nodiscard]] std::string camera_contradiction_note(const CameraContradiction& found);

}  // namespace moiregauge::internal
