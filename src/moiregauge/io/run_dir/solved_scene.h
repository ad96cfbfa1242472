// SPDX-License-Identifier: Apache-2.0
// A solved scene as a site and a camera that can be given back.
#pragma once

#include <array>

#include "moiregauge/calibration/scene/scene.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// A marker as the footage has it: print and circle moved and turned together, the pitch by the print's scale, the
// height where one was solved.
[[nodiscard]] Marker solved_marker(const Site& site, const Scene& scene, std::size_t marker);

// Standard uncertainties of the camera, whatever of it the model holds fixed.
[[nodiscard]] std::array<double, kCameraParameters> u_of_camera(const Scene& scene);

// Standard uncertainties of one marker's x, y (mm), turn (rad), print scale and height (mm); 0 for what was not solved.
[[nodiscard]] MarkerShape u_of_marker(const Scene& scene, std::size_t marker);

// The solved markers; `known_to` is so wide that independent errors of that size cover every error that the markers may
// share (the largest eigenvalue of their covariance), and never narrower for what was not solved.
[[nodiscard]] Site solved_site(const Site& site, const Scene& scene);

}  // namespace moiregauge::internal
