// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/camera/open_camera.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "moiregauge/camera/genicam/genicam_source.h"
#include "moiregauge/camera/network/network_source.h"
#include "moiregauge/camera/pipe/y4m_source.h"

namespace moiregauge::internal {
namespace {

constexpr std::string_view kCamera = "camera", kCameraWithId = "camera:", kPipe = "-";

constexpr std::array<std::string_view, 4> kStreams{"rtsp://", "rtsps://", "http://", "https://"};
constexpr std::string_view kV4l2 = "v4l2:";

bool is_stream(std::string_view source) {
  return std::any_of(kStreams.begin(), kStreams.end(),
                     [&](std::string_view scheme) { return source.starts_with(scheme); });
}
bool is_genicam(std::string_view source) { return source == kCamera || source.starts_with(kCameraWithId); }

std::string refusal(const CameraArgs& args, const std::string& what, const std::string& advice) {
  return fmt::format("{}: {}: {}", what, without_password(args.source), advice);
}

// Reads "X,Y,WIDTH,HEIGHT".
std::optional<SensorRegion> region_of(std::string_view text) {
  std::array<int, 4> numbers{};
  const char* at = text.data();
  const char* end = text.data() + text.size();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto [next, error] = std::from_chars(at, end, numbers[i]);
    const bool is_last = i + 1 == numbers.size();
    if (error != std::errc{} || numbers[i] < 0 || (is_last ? next != end : next == end || *next != ','))
      return std::nullopt;
    at = next + 1;
  }
  if (numbers[2] < 1 || numbers[3] < 1) return std::nullopt;
  return SensorRegion{numbers[0], numbers[1], numbers[2], numbers[3]};
}

std::chrono::milliseconds patience_of(const CameraArgs& args) {
  return std::chrono::milliseconds(static_cast<std::int64_t>(1000.0 * args.patience_s));
}

tl::expected<std::unique_ptr<LiveSource>, InputError> open_industrial(const CameraArgs& args) {
  GenicamSettings settings;
  settings.exposure_us = args.exposure_us;
  settings.gain = args.gain_db;
  settings.fps = args.fps;
  settings.pixel_format = args.pixel_format;
  settings.trigger = args.trigger;
  settings.packet_bytes = args.packet_bytes;
  settings.patience = patience_of(args);
  if (!args.region.empty()) settings.region = region_of(args.region);
  if (args.mosaic == "luma") settings.mosaic = MosaicGrey::kLuma;
  const std::string id = args.source == kCamera ? "" : args.source.substr(kCameraWithId.size());
  return open_genicam(id, settings);
}

// Devices of the kernel, with the names of their drivers.
std::vector<CameraEntry> v4l2_devices() {
  std::vector<CameraEntry> all;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/sys/class/video4linux", ignored)) {
    const std::string device = "/dev/" + entry.path().filename().string();
    std::string name;
    std::ifstream file(entry.path() / "name");
    std::getline(file, name);
    all.push_back({std::string(kV4l2) + device, name, device});
  }
  std::sort(all.begin(), all.end(), [](const CameraEntry& a, const CameraEntry& b) { return a.where < b.where; });
  return all;
}

}  // namespace

bool is_camera_source(std::string_view source) {
  return is_genicam(source) || is_stream(source) || source.starts_with(kV4l2) || source == kPipe;
}

std::string genicam_option(const CameraArgs& args) {
  if (args.exposure_us) return "--exposure";
  if (args.gain_db) return "--gain";
  if (!args.pixel_format.empty()) return "--pixel-format";
  if (!args.region.empty()) return "--sensor-region";
  if (!args.trigger.empty()) return "--trigger";
  if (args.packet_bytes) return "--packet-size";
  return args.mosaic.empty() ? "" : "--mosaic";
}

std::string camera_args_problem(const CameraArgs& args) {
  if (!is_genicam(args.source)) {
    const std::string option = genicam_option(args);
    if (!option.empty())
      return refusal(args, fmt::format("the source has no {}", option),
                     fmt::format("omit {}, or give a GenICam camera", option));
  }
  if (is_stream(args.source) && args.fps)
    return refusal(args, "the times of a stream are those of its camera", "omit --fps");
  if (!args.region.empty() && !region_of(args.region))
    return refusal(args, fmt::format("the region '{}' is not X,Y,WIDTH,HEIGHT", args.region),
                   "give --sensor-region in px of the sensor, e.g. 0,512,2048,1024");
  if (!args.mosaic.empty() && args.mosaic != "green" && args.mosaic != "luma")
    return refusal(args, fmt::format("the mosaic '{}' is unknown", args.mosaic), "give --mosaic green or luma");
  return {};
}

tl::expected<std::unique_ptr<LiveSource>, InputError> open_camera(const CameraArgs& args) {
  const auto unsupported = [](std::string message) {
    return tl::unexpected(InputError{InputErrorKind::kUnsupported, std::move(message)});
  };
  if (std::string problem = camera_args_problem(args); !problem.empty()) return unsupported(std::move(problem));
  if (is_genicam(args.source)) return open_industrial(args);
  if (args.source == kPipe) return open_y4m_pipe(STDIN_FILENO, {args.fps, args.max_pixels});
  if (is_stream(args.source) || args.source.starts_with(kV4l2)) {
    LiveAddress address;
    address.url = args.source;
    address.fps = args.fps;
    return open_network(address, {args.max_pixels, patience_of(args)});
  }
  return unsupported(refusal(args, "the source is no camera", "see `moiregauge live --list`"));
}

std::vector<CameraEntry> list_cameras() {
  std::vector<CameraEntry> all;
  for (const FoundCamera& found : find_genicam_cameras())
    all.push_back({"camera:" + found.id, found.what, found.where});
  for (CameraEntry& device : v4l2_devices()) all.push_back(std::move(device));
  return all;
}

}  // namespace moiregauge::internal
