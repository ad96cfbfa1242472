// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <tl/expected.hpp>

#include "moiregauge/geometry/camera.h"

namespace moiregauge {

// A camera from our TOML ([camera] with run.json's keys) or from a calibration YAML of OpenCV or ROS (camera_matrix and
// distortion_coefficients), told apart by what the file holds. Five terms at most; further ones must be zero.
// fails      "path: what is wrong", for TOML all mistakes at once, a line each
[[nodiscard]] tl::expected<Camera, std::string> read_camera(const std::string& path);
[[nodiscard]] tl::expected<Camera, std::string> parse_camera(const std::string& text, const std::string& path);

// A file that read_camera gives back as it was, to the last bit of every number.
[[nodiscard]] std::string write_camera(const Camera& camera);

}  // namespace moiregauge
