// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/calibration/scene/scene.h"
#include "moiregauge/geometry/camera.h"

namespace moiregauge::internal {

// A camera from our TOML ([camera] with run.json's keys) or from a calibration YAML of OpenCV or ROS (camera_matrix and
// distortion_coefficients), told apart by what the file holds. Five terms at most; further ones must be zero.
// fails      "path:line:column: what is wrong", all mistakes at once, a line each
[[nodiscard]] tl::expected<Camera, std::string> read_camera(const std::string& path);
[[nodiscard]] tl::expected<Camera, std::string> parse_camera(const std::string& text, const std::string& path);

// Standard uncertainties by the Scene's order (f cx cy k1 k2 p1 p2 k3), NaN where the file does not state one.
using CameraWidths = std::array<double, kCameraParameters>;

// The same with what [camera.u] states: how well a camera that was solved is known.
struct KnownCamera {
  Camera camera;
  std::optional<CameraWidths> u;
};
[[nodiscard]] tl::expected<KnownCamera, std::string> read_known_camera(const std::string& path);
[[nodiscard]] tl::expected<KnownCamera, std::string> parse_known_camera(const std::string& text,
                                                                        const std::string& path);

// A file that read_known_camera gives back as it was, to the last bit of every number; a u that is not above 0 is left
// out.
[[nodiscard]] std::string write_camera(const Camera& camera, const CameraWidths& u);

}  // namespace moiregauge::internal
