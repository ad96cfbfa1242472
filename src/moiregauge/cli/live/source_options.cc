// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/live/source_options.h"

#include <algorithm>

#include <fmt/format.h>

#include "moiregauge/base/control_characters.h"
#include "moiregauge/base/duration_text.h"

namespace moiregauge::internal::cli {

void add_source_options(CLI::App& command, SourceTexts& texts) {
  command.add_option("--exposure", texts.exposure, "exposure of a GenICam camera, e.g. 500us [as it is set]")
      ->type_name("TIME");
  command.add_option("--gain", texts.gain, "its gain, in its own unit, usually dB [as it is set]")->type_name("N");
  command.add_option("--pixel-format", texts.pixel_format, "its pixel format, e.g. Mono12 [as it is set]")
      ->type_name("NAME");
  command.add_option("--sensor-region", texts.sensor_region, "the part of its sensor that is read, px [as it is set]")
      ->type_name("X,Y,W,H");
  command.add_option("--trigger", texts.trigger, "its trigger input, e.g. Line1 [free-running]")->type_name("NAME");
  command.add_option("--packet-size", texts.packet_bytes, "bytes of a GigE Vision packet [the largest that arrives]")
      ->check(CLI::Range(576, 65535).description(""))
      ->type_name("N");
  command.add_option("--mosaic", texts.mosaic, "grey of a colour sensor's cells of 2 x 2 px [green]")
      ->type_name("green|luma");
  command.add_option("--patience", texts.patience, "time for which a lost source is searched [60s]")->type_name("TIME");
}

tl::expected<CameraArgs, UsageError> camera_args(const SourceTexts& texts) {
  CameraArgs args;
  if (!texts.exposure.empty()) {
    const auto exposure = duration_s(texts.exposure);
    if (!exposure)
      return usage(fmt::format("the exposure cannot be read: --exposure {}: {}", texts.exposure, exposure.error()));
    args.exposure_us = *exposure * 1e6;
  }
  if (!texts.patience.empty()) {
    const auto patience = long_duration_s(texts.patience);
    if (!patience)
      return usage(fmt::format("the time cannot be read: --patience {}: {}", texts.patience, patience.error()));
    constexpr double kMax_s = 30.0 * 86400.0;
    args.patience_s = std::min(*patience, kMax_s);
  }
  args.gain_db = texts.gain;
  args.pixel_format = texts.pixel_format;
  args.region = texts.sensor_region;
  args.trigger = texts.trigger;
  args.packet_bytes = texts.packet_bytes;
  args.mosaic = texts.mosaic;
  return args;
}

std::string camera_list_text() {
  std::string text;
  std::size_t width = 0;
  const auto cameras = list_cameras();
  for (const CameraEntry& camera : cameras) width = std::max(width, camera.source.size());
  for (const CameraEntry& camera : cameras)
    text += fmt::format("{:<{}}  {}  ({})\n", with_controls_escaped(camera.source), width,
                        with_controls_escaped(camera.what), with_controls_escaped(camera.where));
  return text.empty() ? "no camera was found: check cables, power and the network of GigE cameras\n" : text;
}

}  // namespace moiregauge::internal::cli
