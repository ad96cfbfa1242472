// SPDX-License-Identifier: Apache-2.0
// Converts a solved scene to a site and a camera that can be used for another run.
#pragma once

#include <array>

#include "moiregauge/calibration/scene/scene.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Returns the solved marker. Grating and circle are shifted and rotated together, and the pitch has the solved print
// scale. The height is new if it was solved.
[[nodiscard]] Marker solved_marker(const Site& site, const Scene& scene, std::size_t marker);

// Returns the standard uncertainties of the camera. They include parameters that the model keeps fixed.
[[nodiscard]] std::array<double, kCameraParameters> u_of_camera(const Scene& scene);

// Returns the standard uncertainties of a marker's x and y (mm), rotation (rad), print scale (1) and height (mm). 0:
// not solved.
[[nodiscard]] MarkerShape u_of_marker(const Scene& scene, std::size_t marker);

// Returns the solved site. Independent errors of size `known_to` cover all common errors of the markers: it is the
// root of the largest eigenvalue of their covariance. Parameters that were not solved keep at least their stated value.
[[nodiscard]] Site solved_site(const Site& site, const Scene& scene);

}  // namespace moiregauge::internal
