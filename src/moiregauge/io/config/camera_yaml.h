// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <tl/expected.hpp>

#include "moiregauge/geometry/camera.h"

namespace moiregauge::internal {

// Reads the keys of a calibration file that describe a camera. This is no YAML reader: it knows OpenCV's FileStorage
// and ROS's camera_info. There a key starts a line, and its numbers are in brackets or after dashes.
// Fails with all mistakes, one per line: "path:line:column: what is wrong".
[[nodiscard]] tl::expected<Camera, std::string> parse_camera_yaml(const std::string& text, const std::string& path);

}  // namespace moiregauge::internal
