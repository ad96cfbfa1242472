// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/camera/genicam/genicam_settings.h"

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

using Outcome = tl::expected<void, std::string>;

tl::unexpected<std::string> refusal(const std::string& what, const std::string& name, const std::string& advice) {
  return tl::unexpected(fmt::format("{}: {}: {}", what, name, advice));
}

using Bounds = void (*)(ArvCamera*, double*, double*, GError**);
using Setter = void (*)(ArvCamera*, double, GError**);

struct NumberSetting {
  const char* what;
  const char* option;
  Bounds bounds;
  Setter set;
};

Outcome set_number(ArvCamera& camera, const NumberSetting& setting, double value, const std::string& name) {
  GlibError error;
  double low = 0.0, high = 0.0;
  setting.bounds(&camera, &low, &high, error.out());
  if (!error && !(value >= low && value <= high))
    return refusal(fmt::format("the {} {:g} is outside {:g} to {:g}", setting.what, value, low, high), name,
                   fmt::format("choose {} in this range", setting.option));
  setting.set(&camera, value, error.out());
  if (error)
    return refusal(fmt::format("the camera refused the {} {:g} ({})", setting.what, value, error.text()), name,
                   fmt::format("omit {}", setting.option));
  return {};
}

// Returns the names of all formats that can be measured, for the user.
std::string measurable_formats(ArvCamera& camera) {
  GlibError error;
  guint count = 0;
  gint64* formats = arv_camera_dup_available_pixel_formats(&camera, &count, error.out());
  std::string names;
  for (guint i = 0; formats != nullptr && i < count; ++i) {
    const auto layout = raw_layout(static_cast<std::uint32_t>(formats[i]));
    if (layout) names += fmt::format("{}{}", names.empty() ? "" : ", ", layout->name);
  }
  g_free(formats);
  return names;
}

Outcome set_format(ArvCamera& camera, const std::string& format, const std::string& name) {
  GlibError error;
  if (!format.empty()) arv_camera_set_pixel_format_from_string(&camera, format.c_str(), error.out());
  const bool is_refused = static_cast<bool>(error);
  const ArvPixelFormat now = arv_camera_get_pixel_format(&camera, error.out());
  if (!is_refused && raw_layout(now)) return {};
  return refusal(is_refused ? fmt::format("the camera has no pixel format '{}'", format)
                            : fmt::format("the pixel format {} has no luma",
                                          text_or_empty(arv_camera_get_pixel_format_as_string(&camera, error.out()))),
                 name, fmt::format("choose --pixel-format from {}", measurable_formats(camera)));
}

Outcome set_region(ArvCamera& camera, const SensorRegion& region, const std::string& name) {
  GlibError error, reading;
  int width = 0, height = 0;
  arv_camera_get_sensor_size(&camera, &width, &height, reading.out());
  const bool is_inside = region.x >= 0 && region.y >= 0 && region.width > 0 && region.height > 0 &&
                         region.width <= width - region.x && region.height <= height - region.y;
  SensorRegion now;
  if (is_inside) {
    arv_camera_set_region(&camera, region.x, region.y, region.width, region.height, error.out());
    arv_camera_get_region(&camera, &now.x, &now.y, &now.width, &now.height, reading.out());
  }
  const bool is_set =
      now.x == region.x && now.y == region.y && now.width == region.width && now.height == region.height;
  if (is_inside && !error && is_set) return {};
  return refusal(fmt::format("the camera cannot read the region {},{},{},{} of its {}x{} px", region.x, region.y,
                             region.width, region.height, width, height),
                 name,
                 fmt::format("choose --sensor-region inside the sensor, in steps of {} and {} px",
                             arv_camera_get_width_increment(&camera, reading.out()),
                             arv_camera_get_height_increment(&camera, reading.out())));
}

Outcome set_trigger(ArvCamera& camera, const std::string& trigger, const std::string& name) {
  GlibError error;
  if (trigger.empty()) return {};
  arv_camera_set_trigger(&camera, trigger.c_str(), error.out());
  if (!error) return {};
  guint count = 0;
  GlibError reading;
  const char** sources = arv_camera_dup_available_trigger_sources(&camera, &count, reading.out());
  std::string names;
  for (guint i = 0; sources != nullptr && i < count; ++i) names += fmt::format("{}{}", i == 0 ? "" : ", ", sources[i]);
  g_free(sources);
  return refusal(fmt::format("the camera has no trigger '{}'", trigger), name,
                 fmt::format("choose --trigger from {}", names));
}

Outcome set_packets(ArvCamera& camera, const std::optional<int>& bytes, const std::string& name) {
  if (!arv_camera_is_gv_device(&camera)) {
    if (bytes) return refusal("the camera has no packets", name, "omit --packet-size");
    return {};
  }
  GlibError error;
  if (!bytes) {
    arv_camera_gv_auto_packet_size(&camera, error.out());  // a camera that cannot test its packets keeps its size
    return {};
  }
  arv_camera_gv_set_packet_size(&camera, *bytes, error.out());
  if (error || arv_camera_gv_get_packet_size(&camera, error.out()) != static_cast<guint>(*bytes))
    return refusal(fmt::format("the camera cannot send packets of {} bytes", *bytes), name, "omit --packet-size");
  return {};
}

}  // namespace

tl::expected<void, std::string> apply_settings(ArvCamera& camera, const GenicamSettings& settings,
                                               const std::string& name) {
  GlibError ignored;
  arv_camera_stop_acquisition(&camera, ignored.out());  // an earlier program may have left it running
  arv_camera_set_acquisition_mode(&camera, ARV_ACQUISITION_MODE_CONTINUOUS, ignored.out());
  if (auto done = set_format(camera, settings.pixel_format, name); !done) return done;
  if (settings.region) {
    if (auto done = set_region(camera, *settings.region, name); !done) return done;
  }
  if (settings.fps) {
    const NumberSetting rate{"frame rate", "--fps", arv_camera_get_frame_rate_bounds, arv_camera_set_frame_rate};
    if (auto done = set_number(camera, rate, *settings.fps, name); !done) return done;
  }
  if (settings.exposure_us) {
    const NumberSetting exposure{"exposure in us", "--exposure", arv_camera_get_exposure_time_bounds,
                                 arv_camera_set_exposure_time};
    if (auto done = set_number(camera, exposure, *settings.exposure_us, name); !done) return done;
  }
  if (settings.gain) {
    const NumberSetting gain{"gain", "--gain", arv_camera_get_gain_bounds, arv_camera_set_gain};
    if (auto done = set_number(camera, gain, *settings.gain, name); !done) return done;
  }
  if (auto done = set_trigger(camera, settings.trigger, name); !done) return done;
  return set_packets(camera, settings.packet_bytes, name);
}

std::vector<std::pair<std::string, std::string>> settings_of(ArvCamera& camera) {
  std::vector<std::pair<std::string, std::string>> all;
  const auto add_text = [&](const char* key, const char* (*read)(ArvCamera*, GError**)) {
    GlibError error;
    const std::string text = text_or_empty(read(&camera, error.out()));
    if (!error && !text.empty()) all.emplace_back(key, text);
  };
  const auto add_number = [&](const char* key, double (*read)(ArvCamera*, GError**)) {
    GlibError error;
    const double number = read(&camera, error.out());
    if (!error) all.emplace_back(key, fmt::format("{:.6g}", number));
  };
  add_text("vendor", arv_camera_get_vendor_name);
  add_text("model", arv_camera_get_model_name);
  add_text("serial", arv_camera_get_device_serial_number);
  add_text("pixel_format", arv_camera_get_pixel_format_as_string);
  GlibError error;
  SensorRegion region;
  arv_camera_get_region(&camera, &region.x, &region.y, &region.width, &region.height, error.out());
  if (!error)
    all.emplace_back("sensor_region_px", fmt::format("{},{},{},{}", region.x, region.y, region.width, region.height));
  if (arv_camera_is_frame_rate_available(&camera, error.out())) add_number("frame_rate_hz", arv_camera_get_frame_rate);
  if (arv_camera_is_exposure_time_available(&camera, error.out()))
    add_number("exposure_us", arv_camera_get_exposure_time);
  if (arv_camera_is_gain_available(&camera, error.out())) add_number("gain", arv_camera_get_gain);
  if (arv_camera_is_gv_device(&camera)) {
    const guint bytes = arv_camera_gv_get_packet_size(&camera, error.out());
    if (!error) all.emplace_back("packet_bytes", fmt::format("{}", bytes));
  }
  return all;
}

}  // namespace moiregauge::internal
