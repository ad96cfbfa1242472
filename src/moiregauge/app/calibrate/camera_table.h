// SPDX-License-Identifier: Apache-2.0
// Cameras by name, for planning, with the values that their makers state. They do not replace a calibration.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace moiregauge::internal {

struct NamedCamera {
  std::string_view name;
  std::string_view what;
  int width = 0, height = 0;  // px
  double pixel_um = 0.0;      // 0: hfov_deg is known instead
  double hfov_deg = 0.0;      // 0: the lens is exchangeable (--focal)
  bool rolls = false;         // rolling shutter
  std::string_view source;
  bool compresses = false;  // records with a codec that predicts frames from each other
};

[[nodiscard]] std::optional<NamedCamera> camera_named(const std::string& name);
[[nodiscard]] std::string camera_names();  // "imx250, ..."

}  // namespace moiregauge::internal
