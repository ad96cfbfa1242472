// SPDX-License-Identifier: Apache-2.0
// Options of live sources.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <tl/expected.hpp>

#include "moiregauge/app/usage_error.h"
#include "moiregauge/camera/open_camera.h"

namespace moiregauge::internal::cli {

// Options as typed.
struct SourceTexts {
  std::string exposure;
  std::optional<double> gain;
  std::string pixel_format;
  std::string sensor_region;
  std::string trigger;
  std::optional<int> packet_bytes;
  std::string mosaic;
  std::string patience;
};

// Adds --exposure, --gain, --pixel-format, --sensor-region, --trigger, --packet-size, --mosaic and --patience.
void add_source_options(CLI::App& command, SourceTexts& texts);

// Reads the options. `source`, `fps` and `max_pixels` remain to be set. Fails with the first mistake.
[[nodiscard]] tl::expected<CameraArgs, UsageError> camera_args(const SourceTexts& texts);

// Returns the cameras of this computer and its networks, one per line, for `live --list`.
[[nodiscard]] std::string camera_list_text();

}  // namespace moiregauge::internal::cli
