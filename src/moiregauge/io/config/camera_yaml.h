// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <tl/expected.hpp>

#include "moiregauge/geometry/camera.h"

namespace moiregauge::internal {

// Reads the few keys of a calibration file that a camera needs. Not a YAML reader: it knows OpenCV's FileStorage and
// ROS's camera_info, each a key at the start of a line and its numbers in brackets or behind dashes.
// fails      "path:line:column: what is wrong", all mistakes at once, a line each
[[nodiscard]] tl::expected<Camera, std::string> parse_camera_yaml(const std::string& text, const std::string& path);

}  // namespace moiregauge::internal
