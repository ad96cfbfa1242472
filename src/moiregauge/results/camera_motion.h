// SPDX-License-Identifier: Apache-2.0
// What the camera did meanwhile, as the references show it: for people to see, not for any sample.
#pragma once

#include <optional>
#include <vector>

#include "moiregauge/displacement/method.h"

namespace moiregauge::internal {

// One entry per observation; NaN where the references were not seen. Since the reference frame.
struct CameraMotion {
  std::vector<long> frame;
  std::vector<double> time_s;
  // By which the middle of the references moved in the picture, px, x right, y down.
  std::vector<double> shift_x_px, shift_y_px;
  // By which the board turned before the camera (a camera that turns by itself: the other way), degrees about the
  // camera's x (right), y (down), z (forward): parts of one turn about one axis. Empty when no camera is known.
  std::vector<double> turn_x_deg, turn_y_deg, turn_z_deg;
};

// `camera`: f, cx and cy, solved or given; none: shifts only, an angle needs a focal length. A method that takes the
// camera to stand still sees no motion.
[[nodiscard]] CameraMotion camera_motion(const Reference& reference, const Observations& observations,
                                         const std::optional<Camera>& camera);

// The camera to give to it: the solved one where the footage determines its focal length, else the given one.
[[nodiscard]] std::optional<Camera> known_camera(const Reference& reference, const std::optional<Scene>& scene);

}  // namespace moiregauge::internal
