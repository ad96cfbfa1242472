// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/plan/plan_args.h"

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "moiregauge/app/calibrate/camera_table.h"
#include "moiregauge/base/duration_text.h"
#include "moiregauge/base/length_text.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/io/config/camera_file.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::cli {
namespace {

constexpr double kLayoutShare = 0.8;  // relative to the image, without --span; the rest allows for camera rotation

// A telephone's codec: most of its frames are predicted from others.
constexpr Quantiser kUsualCodec{kUsualStep, true};

std::optional<double> number_of(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !(value > 0.0)) return std::nullopt;
  return value;
}

// Reads "4104x1012".
std::optional<std::pair<int, int>> pixels_of(const std::string& text) {
  const auto cross = text.find('x');
  if (cross == std::string::npos) return std::nullopt;
  const auto w = number_of(std::string_view(text).substr(0, cross)),
             h = number_of(std::string_view(text).substr(cross + 1));
  if (!w || !h || *w < 16 || *h < 16 || *w > 1e5 || *h > 1e5 || *w != std::floor(*w) || *h != std::floor(*h))
    return std::nullopt;
  return std::pair{static_cast<int>(*w), static_cast<int>(*h)};
}

// Reads "0.5mm@5Hz": an amplitude by `amplitude_of`, then the frequency in Hz.
template <typename Amplitude>
std::optional<Swing> swing_from(const std::string& text, Amplitude amplitude_of) {
  const auto at = text.find('@');
  if (at == std::string::npos || text.size() < at + 4 || text.substr(text.size() - 2) != "Hz") return std::nullopt;
  const auto frequency = number_of(std::string_view(text).substr(at + 1, text.size() - at - 3));
  const std::optional<double> amplitude = amplitude_of(text.substr(0, at));
  constexpr double kMaxAmplitude = 1e5;  // mm or rad, for finite arithmetic (chosen)
  constexpr double kMaxFrequency_hz = 1e6;
  if (!frequency || !amplitude || *frequency > kMaxFrequency_hz || *amplitude > kMaxAmplitude) return std::nullopt;
  return Swing{*amplitude, *frequency};
}

std::optional<double> mm_of(const std::string& text) {
  const auto mm = length_mm(text);
  return mm ? std::optional(*mm) : std::nullopt;
}

std::optional<double> rad_of(const std::string& text) {
  if (text.size() < 4 || text.substr(text.size() - 3) != "deg") return std::nullopt;
  const auto degrees = number_of(std::string_view(text).substr(0, text.size() - 3));
  return degrees ? std::optional(radians_from_degrees(*degrees)) : std::nullopt;
}

using Done = tl::expected<void, UsageError>;

// Sets the camera's size and focal length (px) from a name, a file or numbers.
Done choose_camera(const PlanArgs& args, PlanOrder& order) {
  Camera& camera = order.setup.camera;
  double pixel_mm = 0.0, fov_deg = args.fov_deg.value_or(0.0);
  if (!args.camera.empty()) {
    order.camera_name = args.camera;
    if (const auto known = camera_named(args.camera)) {
      camera.width = known->width, camera.height = known->height;
      pixel_mm = 0.001 * known->pixel_um;
      if (fov_deg == 0.0 && args.focal.empty()) fov_deg = known->hfov_deg;
      order.camera_source = known->source;
      if (known->compresses) order.setup.codec = kUsualCodec;
      order.readout_unknown = known->rolls && args.readout.empty();
    } else if (std::filesystem::exists(args.camera)) {
      const auto read = read_camera(args.camera);
      if (!read) return usage(mistakes_in("camera file", args.camera, read.error()));
      if (read->width <= 0)
        return usage(fmt::format("the camera file has no image size: {}: add width and height to it", args.camera));
      if (!args.focal.empty() || args.fov_deg || !args.resolution.empty())
        return usage(
            "--camera FILE excludes --focal, --fov and --resolution: the file states them: remove those options");
      camera = *read;
      return {};
    } else {
      return usage(fmt::format("the camera is unknown: --camera {}: give a camera file, or one of {}", args.camera,
                               camera_names()));
    }
  }
  if (!args.resolution.empty()) {
    const auto size = pixels_of(args.resolution);
    if (!size)
      return usage(
          fmt::format("the resolution cannot be read: --resolution {}: write pixels, e.g. 4096x2160", args.resolution));
    // Another video mode of a telephone has the same field of view. A sensor that is partly read has the same pixel
    // size.
    camera.width = size->first, camera.height = size->second;
  }
  if (camera.width == 0)
    return usage(
        "the camera is missing: plan: give --camera NAME, or --resolution 4096x2160 with --fov 60 or --pixel 3.45um "
        "--focal 12mm");
  const auto pixel = length_or("--pixel", args.pixel, pixel_mm);
  if (!pixel) return tl::unexpected(pixel.error());
  const auto focal = length_or("--focal", args.focal, 0.0);
  if (!focal) return tl::unexpected(focal.error());
  if (*focal > 0.0 && args.fov_deg)
    return usage("--focal and --fov exclude each other: both state the lens: give one of them");
  if (*focal > 0.0 && !(*pixel > 0.0))
    return usage("the pixel size is missing: --focal: add e.g. --pixel 3.45um, or give --fov instead");
  if (*focal > 0.0) {
    camera.fx = *focal / *pixel;
  } else if (fov_deg > 0.0 && fov_deg < 170.0) {
    camera.fx = 0.5 * camera.width / std::tan(0.5 * radians_from_degrees(fov_deg));
  } else {
    return usage(
        "the lens is missing: plan: give --focal 12mm (with --pixel, unless the camera is named), or --fov in degrees");
  }
  camera.fy = camera.fx;
  camera.cx = 0.5 * (camera.width - 1), camera.cy = 0.5 * (camera.height - 1);
  return {};
}

Done choose_numbers(const PlanArgs& args, RecordingSetup& setup) {
  const struct {
    const char* option;
    double value, low, high;
  } numbers[] = {{"--noise", args.noise, 0.0, 100.0},
                 {"--contrast", args.contrast, 1.0, 255.0},
                 {"--psf", args.psf_px, 0.0, 20.0},
                 {"--fps", args.fps, 1e-6, 1e6}};
  for (const auto& number : numbers) {
    if (!(number.value >= number.low && number.value <= number.high))
      return usage(fmt::format("the number is out of range: {} {:g}: give {:g} to {:g}", number.option, number.value,
                               number.low, number.high));
  }
  setup.noise_sigma = args.noise;
  setup.optics.contrast = args.contrast;
  setup.optics.psf_sigma_px = args.psf_px;
  setup.fps = args.fps;
  const struct {
    const char* option;
    const std::string& text;
    double& value;
  } times[] = {{"--exposure", args.exposure, setup.exposure_s}, {"--readout", args.readout, setup.readout_s}};
  for (const auto& time : times) {
    if (time.text.empty()) continue;
    const auto seconds = duration_s(time.text);
    if (!seconds)
      return usage(fmt::format("the time cannot be read: {} {}: {}", time.option, time.text, seconds.error()));
    time.value = *seconds;
  }
  if (args.exposure.empty()) setup.exposure_s = 0.25 / setup.fps;
  if (setup.exposure_s > 1.0 / setup.fps * (1.0 + 1e-9))
    return usage(fmt::format("the exposure is longer than a frame: --exposure {} at {:g} frames/s: give a shorter time",
                             args.exposure, setup.fps));
  return {};
}

Done choose_swings(const PlanArgs& args, RecordingSetup& setup) {
  if (!args.vibration.empty()) {
    setup.target_swing = swing_from(args.vibration, mm_of);
    if (!setup.target_swing)
      return usage(
          fmt::format("the vibration cannot be read: --vibration {}: write amplitude and frequency, e.g. 0.5mm@5Hz",
                      args.vibration));
  }
  if (!args.camera_vibration.empty()) {
    setup.camera_swing = swing_from(args.camera_vibration, rad_of);
    if (!setup.camera_swing)
      return usage(fmt::format(
          "the vibration cannot be read: --camera-vibration {}: write amplitude and frequency, e.g. 0.01deg@10Hz",
          args.camera_vibration));
  }
  return {};
}

// Returns the usual pitch of 10 mm if the image shows it well, otherwise the next round pitch of at least kGoodPitch_px.
double round_pitch_mm(double px_per_mm) {
  constexpr double kUsualPitch_mm = 10.0, kGoodPitch_px = 12.0;
  constexpr std::array kRound{1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0};
  const double usual_px = kUsualPitch_mm * px_per_mm;
  if (usual_px >= kFinestGoodPitch_px && usual_px <= kCoarsestGoodPitch_px) return kUsualPitch_mm;
  const double least = kGoodPitch_px / px_per_mm, decade = std::pow(10.0, std::floor(std::log10(least)));
  for (const double round : kRound) {
    if (round * decade >= least) return round * decade;
  }
  return 10.0 * decade;
}

Done choose_layout(const PlanArgs& args, PlanOrder& order) {
  RecordingSetup& setup = order.setup;
  const double scale = px_per_mm(setup);
  LayoutArgs wanted = args.layout;
  order.is_pitch_chosen = wanted.site.empty() && wanted.pitch.empty();
  if (order.is_pitch_chosen) wanted.pitch = fmt::format("{:g}mm", round_pitch_mm(scale));
  auto layout = site_of_layout(
      wanted, {"the image", {kLayoutShare * setup.camera.width / scale, kLayoutShare * setup.camera.height / scale}});
  if (!layout) return tl::unexpected(layout.error());
  Site* const site = &layout->site;
  int references = 0, targets = 0;
  for (const Marker& marker : site->markers) {
    if (!marker.grating) continue;
    (marker.role == Role::kReference ? references : targets) += 1;
    const double height = marker.z_mm.value_or(0.0);
    if (!(height < setup.distance_mm))
      return usage(fmt::format("the marker is behind the camera: '{}': give a larger --distance", marker.name));
    const double pitch = marker.grating->pitch_mm * px_per_mm(setup, height);
    if (!(pitch >= 2.5))
      return usage(
          fmt::format("the pitch is too fine to measure: '{}', {:.2g} px in the image (2.5 is the minimum): choose a "
                      "larger --pitch or move closer",
                      marker.name, pitch));
  }
  if (references < 4 || targets < 1)
    return usage(
        fmt::format("the site has too few markers: {} references and {} targets with gratings: add markers, "
                    "four references and one target at least",
                    references, targets));
  setup.site = std::move(layout->site);
  order.request = layout->request;
  order.layout_note = layout->note;
  order.site_file = args.layout.site;
  return {};
}

}  // namespace

tl::expected<PlanOrder, UsageError> parse_plan_options(const PlanArgs& args) {
  PlanOrder order;
  if (args.distance.empty())
    return usage("the distance is missing: plan: give --distance from the camera to the markers, e.g. 5m");
  const auto distance = length_or("--distance", args.distance, 0.0);
  if (!distance) return tl::unexpected(distance.error());
  order.setup.distance_mm = *distance;
  if (const auto done = choose_camera(args, order); !done) return tl::unexpected(done.error());
  if (args.lossless && args.compressed)
    return usage("--lossless and --compressed exclude each other: plan: give one of them");
  if (args.lossless) order.setup.codec = {};
  if (args.compressed) order.setup.codec = kUsualCodec;
  for (const auto step : {choose_numbers, choose_swings}) {
    if (const auto done = step(args, order.setup); !done) return tl::unexpected(done.error());
  }
  if (const auto done = choose_layout(args, order); !done) return tl::unexpected(done.error());
  return order;
}

}  // namespace moiregauge::internal::cli
