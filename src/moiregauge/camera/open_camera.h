// SPDX-License-Identifier: Apache-2.0
// Opens the source of a live run by its text.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/run/live_source.h"

namespace moiregauge::internal {

// Options of live sources. An option that the source does not have is refused.
struct CameraArgs {
  std::string source;         // SOURCE as typed
  std::optional<double> fps;  // --fps, frames/s; a GenICam camera is set to it, other sources get their times by it
  std::int64_t max_pixels = 64'000'000;  // --max-pixels
  // GenICam cameras. Empty: as the camera is set.
  std::optional<double> exposure_us;  // --exposure, us
  std::optional<double> gain_db;      // --gain, dB or the camera's unit
  std::string pixel_format;           // --pixel-format, e.g. "Mono12"
  std::string region;                 // --sensor-region, "X,Y,WIDTH,HEIGHT" in px of the sensor
  std::string trigger;                // --trigger, e.g. "Line1"
  std::optional<int> packet_bytes;    // --packet-size, bytes of a GigE Vision packet; nothing: the largest that arrives
  std::string mosaic;                 // --mosaic: "green" (default) or "luma"
  // Network streams and GenICam cameras: time until a lost source ends the run, s.
  double patience_s = 60.0;  // --patience
};

// Returns true for `camera`, `camera:ID`, `v4l2:/dev/videoN`, `rtsp://...`, `rtsps://...`, `http://...`, `https://...`
// and `-`.
[[nodiscard]] bool is_camera_source(std::string_view source);

// Returns the first option given that only GenICam cameras have, or an empty text.
[[nodiscard]] std::string genicam_option(const CameraArgs& args);

// Returns the first wrong option as "what happened: where: what to do", or an empty text. Opens nothing.
[[nodiscard]] std::string camera_args_problem(const CameraArgs& args);

// Opens a source and starts it. Fails with "what happened: where: what to do": kUnsupported also for a wrong option.
[[nodiscard]] tl::expected<std::unique_ptr<LiveSource>, InputError> open_camera(const CameraArgs& args);

// A GenICam camera or V4L2 device found on this computer and its networks.
struct CameraEntry {
  std::string source;  // text for SOURCE, e.g. "camera:Basler-21766911"
  std::string what;    // vendor, model, serial number
  std::string where;   // network address, "usb" or the device's name
};
[[nodiscard]] std::vector<CameraEntry> list_cameras();

}  // namespace moiregauge::internal
