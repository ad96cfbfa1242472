// SPDX-License-Identifier: Apache-2.0
// Industrial cameras (GigE Vision, USB3 Vision) as a LiveSource, through Aravis.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/camera/genicam/raw_pixels.h"
#include "moiregauge/run/live_source.h"

namespace moiregauge::internal {

// Region of the sensor, px.
struct SensorRegion {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

// Settings of a camera. Empty: as the camera is set.
struct GenicamSettings {
  std::optional<double> exposure_us{};
  std::optional<double> gain{};  // dB or the camera's unit
  std::optional<double> fps{};   // frames/s
  std::string pixel_format{};    // PFNC name
  std::optional<SensorRegion> region{};
  std::string trigger{};              // a source of the camera's frame trigger, e.g. "Line1"
  std::optional<int> packet_bytes{};  // nothing: the largest that arrives is determined
  MosaicGrey mosaic = MosaicGrey::kGreen;
  std::chrono::milliseconds patience = std::chrono::seconds(60);  // until a lost camera ends the source
};

// Opens the camera with this identifier, serial number or network address, or the first one if `id` is empty. Starts
// it.
//
// Aravis receives frames into a pool of buffers on its own thread. A frame without a free buffer is lost and counted,
// and one with missing packets is counted and never delivered. Times are those of the camera's clock.
// A lost camera is searched for with increasing intervals, and gets the same settings.
// Fails: no such camera (kUnreadable), a setting that it does not have, pixels without luma (kUnsupported).
[[nodiscard]] tl::expected<std::unique_ptr<LiveSource>, InputError> open_genicam(const std::string& id,
                                                                                 const GenicamSettings& settings);

struct FoundCamera {
  std::string id;
  std::string what;   // vendor, model, serial number
  std::string where;  // network address or bus
};
[[nodiscard]] std::vector<FoundCamera> find_genicam_cameras();

}  // namespace moiregauge::internal
