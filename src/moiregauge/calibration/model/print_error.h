// SPDX-License-Identifier: Apache-2.0
// Print error: the excess of residuals over noise. Gratings are rough, curl a little, and their templates are not
// perfect. On a photographed board the nine points of a grating have residuals of 0.02 px, where noise predicts 0.003
// px.
#pragma once

#include <span>
#include <vector>

#include "moiregauge/calibration/scene/bundle.h"
#include "moiregauge/calibration/scene/frame_fit.h"

namespace moiregauge::internal {

struct PrintError {
  // Standard uncertainty (k = 1) of each coordinate of the nine points, mm. It counts once per point and once in
  // common, because errors of a grating extend over its neighbourhood. All references share one. Each target has its
  // own: one per site marker, or empty if there is none. Otherwise a deformed target would loosen the references, and
  // lens and tilts would follow it.
  double references_mm = 0.0;
  std::vector<double> targets_mm = {};
  // Common to the nine points only: the marker jitter.
  double marker_jitter_mm = 0.0;
  // True noise of the points relative to the noise from pixel residuals (ratio of u).
  double noise_share = 1.0;

  // Returns the print error of a site's marker, mm.
  [[nodiscard]] double of_marker(const Site& site, std::size_t marker) const {
    if (site.markers[marker].role == Role::kReference) return references_mm;
    return marker < targets_mm.size() ? targets_mm[marker] : 0.0;
  }
  // Returns true if the points of any print exceed noise.
  [[nodiscard]] bool has_rough_prints() const;
  // Returns true if anything is added to the noise.
  [[nodiscard]] bool exceeds_noise() const { return has_rough_prints() || marker_jitter_mm > 0.0; }
};

// Returns true if print errors and marker jitter differ by no more than `share` of the second.
[[nodiscard]] bool are_alike(const PrintError& a, const PrintError& b, double share);

// Returns the frames with this error included in the points' covariance.
[[nodiscard]] std::vector<BundleFrame> with_print_error(const Site& site, std::span<const BundleFrame> frames,
                                                        const PrintError& error);

// Returns how far the frames determine each scene parameter: 1 if wholly, 0 if the prior does. `covariance`: of the scene.
[[nodiscard]] Eigen::VectorXd determined(std::span<const FrameFit> fits, const Eigen::MatrixXd& covariance);

// Returns the print errors u_p in mm: with them, chi2 of the references and of each target equals its degrees of
// freedom. They are 0 where noise explains chi2, and at most 0.05 pitch. All parameters must be free in the scene.
// Otherwise an excluded height counts as print error. The result has no jitter and noise share 1.
// With a rolling shutter all prints share one print error.
//
// `frames`: covariance of noise and marker jitter only, with solved poses and shifts.
// `fits`: fits of these frames to the scene, with any print error.
// `prior`: of the scene. Parameters that the footage determines cost degrees of freedom.
[[nodiscard]] PrintError print_error(const Site& site, const Scene& scene, std::span<const BundleFrame> frames,
                                     std::span<const FrameFit> fits, const ScenePrior& prior);

// Returns the print error of a target in this frame alone, mm. It comes in addition to the error in the points' covariance.
// With it, chi2 of the points equals its degrees of freedom. It is 0 where the covariance explains chi2, and at most 0.05
// pitch. It is that of an image that is blurred or partly covered, which is no property of the print.
// `fit`: of the frame to the scene.
[[nodiscard]] double error_in_frame(const Site& site, const Scene& scene, const BundleFrame& frame, const FrameFit& fit,
                                    std::size_t target);

// Returns the true noise of the points relative to that from the pixel residuals (ratio of u, at most 1). Residuals
// also contain the template's errors at edges, which are the same in all frames. Then chi2 is below its degrees of
// freedom. 100 more degrees of freedom favour the stated noise in short runs.
[[nodiscard]] double noise_share(const Site& site, const SceneModel& model, std::span<const FrameFit> fits,
                                 const ScenePrior& prior);

}  // namespace moiregauge::internal
