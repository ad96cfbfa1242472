// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/calibration/scene/scene.h"
#include "moiregauge/geometry/camera.h"

namespace moiregauge::internal {

// Reads a camera from TOML ([camera] with the keys of run.json), or from a calibration YAML of OpenCV or ROS
// (camera_matrix and distortion_coefficients). The content decides which. At most five distortion terms: further ones
// must be zero.
// Fails with all mistakes, one per line: "path:line:column: what is wrong".
[[nodiscard]] tl::expected<Camera, std::string> read_camera(const std::string& path);
[[nodiscard]] tl::expected<Camera, std::string> parse_camera(const std::string& text, const std::string& path);

// Standard uncertainties in the order of the scene (f cx cy k1 k2 p1 p2 k3). NaN: not stated by the file.
using CameraWidths = std::array<double, kCameraParameters>;

// A camera with the standard uncertainties of [camera.u], if the file has them.
struct KnownCamera {
  Camera camera;
  std::optional<CameraWidths> u;
};
[[nodiscard]] tl::expected<KnownCamera, std::string> read_known_camera(const std::string& path);
[[nodiscard]] tl::expected<KnownCamera, std::string> parse_known_camera(const std::string& text,
                                                                        const std::string& path);

// Returns a file that read_known_camera reads back to the last bit. Omits uncertainties that are not above 0.
[[nodiscard]] std::string write_camera(const Camera& camera, const CameraWidths& u);

}  // namespace moiregauge::internal
