// SPDX-License-Identifier: Apache-2.0
// Camera motion as the references show it, for information only. No sample depends on it.
#pragma once

#include <optional>
#include <vector>

#include "moiregauge/displacement/method.h"

namespace moiregauge::internal {

// One entry per observation, since the reference frame. NaN: the references were not seen.
struct CameraMotion {
  std::vector<long> frame;
  std::vector<double> time_s;
  // Shift of the references' middle in the image, px, x right, y down.
  std::vector<double> shift_x_px, shift_y_px;
  // Rotation of the board relative to the camera, deg, about the camera's x (right), y (down) and z (forward). The
  // three are parts of one rotation about one axis. If the camera rotates, the signs are opposite. Empty: no camera is
  // known.
  std::vector<double> turn_x_deg, turn_y_deg, turn_z_deg;
};

// Returns the camera motion from the views of all observations. `camera`: f, cx and cy, solved or given. Without it
// there are shifts only, because an angle requires a focal length. Methods that assume a fixed camera see no motion.
[[nodiscard]] CameraMotion camera_motion(const Reference& reference, const Observations& observations,
                                         const std::optional<Camera>& camera);

// Returns the camera for `camera_motion`: the solved one if the footage determines its focal length, otherwise the
// given one. Nothing if neither exists.
[[nodiscard]] std::optional<Camera> known_camera(const Reference& reference, const std::optional<Scene>& scene);

}  // namespace moiregauge::internal
