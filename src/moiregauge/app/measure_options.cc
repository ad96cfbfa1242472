// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/measure_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "moiregauge/app/frame_range_text.h"
#include "moiregauge/base/control_characters.h"
#include "moiregauge/base/duration_text.h"
#include "moiregauge/base/length_text.h"
#include "moiregauge/base/plain_file.h"
#include "moiregauge/io/config/camera_file.h"
#include "moiregauge/io/config/site_file.h"
#include "moiregauge/results/derived/site_channels.h"

namespace moiregauge::internal {
namespace {

std::string method_names() {
  std::string names;
  for (const Method& method : kMethods) names += fmt::format("{}{}", names.empty() ? "" : ", ", method.name);
  return names;
}

// Fails if there is no plain file of this name.
tl::expected<void, UsageError> is_there(const std::string& kind, const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    return usage(fmt::format("the {} does not exist: {}: check the name", kind, as_one_line(path)));
  const std::string other = kind_unless_plain(path);
  if (other.empty()) return {};
  return usage(fmt::format("the {} is {}: {}: give a plain file", kind, other, as_one_line(path)));
}

// A site file is often in the folder of the images or of the clip. The message names it, but it is not used without
// the option: the scale of the results must be stated, not found.
UsageError no_scale(const std::string& input) {
  namespace fs = std::filesystem;
  std::string site = "a site file (docs/file-formats.md)";
  for (const fs::path& candidate : {fs::path(input) / "site.toml", fs::path(input).parent_path() / "site.toml"}) {
    std::error_code error;
    if (!fs::is_regular_file(candidate, error)) continue;
    site = fmt::format("the site file next to it, --site {}", candidate.string());
    break;
  }
  const std::string remedy = "give the gratings' pitch, e.g. --pitch 10mm, or " + site;
  // Patterns, addresses and "-" are no names of files.
  std::error_code error;
  const bool is_name = input.find_first_of("%:") == std::string::npos && input != "-";
  if (is_name && !fs::exists(input, error))
    return {fmt::format("the file or folder does not exist: {}: check the name, and {}", as_one_line(input), remedy)};
  return {fmt::format("the scale is unknown: {}: {}", as_one_line(input), remedy)};
}

}  // namespace

tl::expected<const Method*, UsageError> method_of(const std::string& word) {
  const Method* method = method_named(word);
  if (method == nullptr)
    return usage(fmt::format("the method is unknown: --method {}: choose one of {}", word, method_names()));
  return method;
}

tl::expected<void, UsageError> take_site(const std::string& path, MeasureOptions& options) {
  if (auto found = is_there("site file", path); !found) return found;
  auto file = read_site_file(path);
  if (!file) return usage(mistakes_in("site file", path, fmt::format("{}", fmt::join(file.error(), "\n"))));
  options.site = std::move(file->site);
  options.channels = std::move(file->channels);
  return {};
}

tl::expected<Site, UsageError> site_of_file(const std::string& path) {
  MeasureOptions options;
  return take_site(path, options).map([&] { return std::move(options.site); });
}

tl::expected<void, UsageError> take_camera(const std::string& path, MeasureOptions& options) {
  if (auto found = is_there("camera file", path); !found) return found;
  const auto known = read_known_camera(path);
  if (!known) return usage(mistakes_in("camera file", path, known.error()));
  options.camera = known->camera;
  options.solve.u_camera = known->u;
  return {};
}

tl::expected<double, UsageError> readout_time(const std::string& text) {
  const auto seconds = duration_s(text);
  if (!seconds) return usage(fmt::format("the readout time cannot be read: --readout {}: {}", text, seconds.error()));
  return *seconds;
}

namespace {

// Largest stretch of a printer. A larger difference is another pitch. Chosen.
constexpr double kMaxStretch = 0.05;

std::optional<double> parse_factor(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !(std::abs(value - 1.0) <= kMaxStretch))
    return std::nullopt;
  return value;
}

}  // namespace

tl::expected<std::optional<PrintScale>, UsageError> print_scale_of(const PrintScaleArgs& args) {
  if (args.factor.empty()) {
    if (args.u)
      return usage(
          "the print scale is missing: --u-print-scale: add what the rulers showed, e.g. --print-scale 1.0012");
    return std::nullopt;
  }
  const std::string_view text = args.factor;
  const auto comma = text.find(',');
  const auto x = parse_factor(text.substr(0, comma));
  const auto y = comma == std::string_view::npos ? x : parse_factor(text.substr(comma + 1));
  if (!x || !y)
    return usage(
        fmt::format("the print scale cannot be read: --print-scale {}: write measured / nominal length of the rulers, "
                    "e.g. 1.0012, or along x and y 1.0012,0.9990",
                    args.factor));
  PrintScale scale = mean_of_rulers(*x, *y);
  if (!args.u) return scale;
  if (!(*args.u > 0.0 && *args.u <= kMaxStretch))
    return usage(
        fmt::format("the uncertainty is out of range: --u-print-scale {}: write a relative standard uncertainty, e.g. "
                    "0.0002 (0.02 mm of 100 mm)",
                    *args.u));
  scale.u = *args.u;
  return scale;
}

tl::expected<void, UsageError> check_times(std::optional<double> fps, std::optional<double> slow_motion) {
  // One image in eleven days to a million per second: beyond these, times are lost in rounding.
  if (fps && !(*fps >= 1e-6 && *fps <= 1e6))
    return usage(fmt::format(
        "the frame rate is out of range: --fps {}: give a number above 0, up to 1000000, e.g. --fps 25", *fps));
  // A factor below 1 is a time lapse.
  if (slow_motion && !(*slow_motion >= 1e-6 && *slow_motion <= 1e6))
    return usage(fmt::format(
        "the factor is out of range: --slow-motion {}: give the recorded by the stored frame rate, e.g. 8 for 240 "
        "frames/s stored as 30",
        *slow_motion));
  return {};
}

std::string mistakes_in(const std::string& kind, const std::string& path, const std::string& lines) {
  const auto count = 1 + std::count(lines.begin(), lines.end(), '\n');
  return fmt::format("the {} has mistakes: {}: correct {}\n{}", kind, path,
                     count == 1 ? "this mistake:" : fmt::format("these {} mistakes:", count), lines);
}

std::string default_output(const std::string& input, const std::string& suffix) {
  namespace fs = std::filesystem;
  fs::path path = fs::path(input).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  std::string name = path.filename().string();
  if (name == "." || name == "..") name = fs::absolute(path).lexically_normal().filename().string();
  if (const auto percent = name.find('%'); percent != std::string::npos) {
    name.resize(percent);
  } else if (std::error_code error; !fs::is_directory(input, error)) {
    name = fs::path(name).stem().string();
  }
  while (!name.empty() && (name.back() == '_' || name.back() == '-')) name.pop_back();
  return (name.empty() ? "run" : name) + suffix;
}

std::optional<std::string> camera_problem(const Camera& camera, const InputInfo& input) {
  if (camera.width <= 0 || (camera.width == input.width && camera.height == input.height)) return std::nullopt;
  return fmt::format(
      "the camera file is for {} x {} px and the frames have {} x {}: {}: calibrate at the recording's size",
      camera.width, camera.height, input.width, input.height, input.path);
}

namespace {

using Parsed = tl::expected<void, UsageError>;

// --resume, --restart, --pitch, --site and --axes exclude each other in part.
Parsed check_combinations(const MeasureArgs& args) {
  if (args.resume && args.restart) return usage("--resume and --restart exclude each other: measure: give one of them");
  if (!args.pitch.empty() && !args.site.empty())
    return usage("--pitch and --site exclude each other: the site file states the pitch: give one of them");
  if (!args.axes.empty() && args.pitch.empty())
    return usage("--axes applies to --pitch only: the site file states the axes: remove --axes");
  if (!args.axes.empty() && args.axes != "print" && args.axes != "image")
    return usage(fmt::format("the axes are unknown: --axes {}: choose one of print, image", args.axes));
  if (args.site.empty() && args.pitch.empty()) return tl::unexpected(no_scale(args.input));
  if (args.exaggeration && !args.video)
    return usage("--exaggerate applies to --video only: measure: add --video, or remove --exaggerate");
  return {};
}

// A method that needs circles cannot use a site without any.
Parsed check_references(const MeasureArgs& args, MeasureOptions& options) {
  const auto& markers = options.site.markers;
  const bool has_any = std::any_of(markers.begin(), markers.end(), [](const Marker& marker) {
    return marker.role == Role::kReference && marker.circle.has_value();
  });
  if (args.site.empty() || has_any || !options.method->needs_circles) return {};
  return usage(fmt::format(
      "the method {} requires 4 reference circles: --site {}: add [[reference]] markers, or give --method conventional",
      options.method->name, args.site));
}

// Reads the choice of markers. Names of a site file can be checked now, those of a detected site when it is known.
Parsed choose(const MarkerChoiceArgs& args, MeasureOptions& options) {
  auto choice = marker_choice_of(args);
  if (!choice) return tl::unexpected(choice.error());
  auto area = search_area_of(args);
  if (!area) return tl::unexpected(area.error());
  options.choice = *std::move(choice);
  options.observe.area = *std::move(area);
  if (options.pitch_mm || options.choice.is_empty()) return {};
  auto site = choose_markers(options.site, options.choice);
  if (!site) return usage(site.error());
  options.channels = renamed_channels(std::move(options.channels), options.site, options.choice.names);
  options.site = *std::move(site);
  if (std::none_of(options.site.markers.begin(), options.site.markers.end(),
                   [](const Marker& marker) { return marker.role == Role::kTarget; }))
    return usage("no target is left: --targets, --ignore: choose at least one marker that moves");
  return {};
}

// Reads the gratings, their positions and their scale.
Parsed parse_prints(const MeasureArgs& args, MeasureOptions& options) {
  if (args.axes == "image") options.axes = BoardAxes::kImage;
  if (!args.pitch.empty()) {
    const auto pitch = length_mm(args.pitch);
    if (!pitch) return usage(fmt::format("the pitch cannot be read: --pitch {}: {}", args.pitch, pitch.error()));
    options.pitch_mm = *pitch;
  }
  if (!args.site.empty()) {
    if (auto taken = take_site(args.site, options); !taken) return taken;
  }
  if (auto chosen = choose(args.choice, options); !chosen) return chosen;
  const auto print_scale = print_scale_of(args.print_scale);
  if (!print_scale) return tl::unexpected(print_scale.error());
  if (!*print_scale) return {};
  options.print_scale = **print_scale;
  options.site = with_prints_scaled(std::move(options.site), **print_scale);
  if (options.pitch_mm) *options.pitch_mm *= options.print_scale.factor;
  return {};
}

Parsed parse_frames(const MeasureArgs& args, MeasureOptions& options) {
  if (auto checked = check_times(args.fps, args.slow_motion); !checked) return checked;
  if (!args.frames.empty()) {
    const auto range = frame_range_in(args.frames, kFramesOption);
    if (!range) return tl::unexpected(range.error());
    options.frames = *range;
  }
  if (!args.rest.empty()) {
    const auto rest = frame_range_in(args.rest, kRestOption);
    if (!rest) return tl::unexpected(rest.error());
    options.solve.rest = *rest;
  }
  if (!args.zero.empty()) {
    const auto zero = frame_range_in(args.zero, kZeroOption);
    if (!zero) return tl::unexpected(zero.error());
    options.zero = *zero;
  }
  if (args.reference_frame && *args.reference_frame < 0)
    return usage(
        fmt::format("the frame number is negative: --reference-frame {}: give a frame of the input, the first is 0",
                    *args.reference_frame));
  options.reference_frame = args.reference_frame;
  return {};
}

Parsed parse_camera(const MeasureArgs& args, MeasureOptions& options) {
  if (!args.camera.empty()) {
    if (auto taken = take_camera(args.camera, options); !taken) return taken;
  }
  if (!args.readout.empty()) {
    const auto readout = readout_time(args.readout);
    if (!readout) return tl::unexpected(readout.error());
    options.solve.readout_s = *readout;
  }
  if (args.tone.empty() || args.tone == "auto") return {};
  options.tone = tone_curve_named(args.tone);
  if (!options.tone)
    return usage(fmt::format(
        "the tone curve is unknown: --tone {}: choose one of auto, linear, srgb, bt709, hlg, pq, gamma:2.2 (0.2 to 5)",
        args.tone));
  return {};
}

Parsed parse_details(const MeasureArgs& args, MeasureOptions& options) {
  if (!args.template_use.empty()) {
    const auto use = template_use_named(args.template_use);
    if (!use)
      return usage(fmt::format("the word is unknown: --template {}: choose one of auto, on, off", args.template_use));
    options.observe.template_use = *use;
  }
  if (args.exaggeration && !(*args.exaggeration >= 1.0 && *args.exaggeration <= 1e5))
    return usage(
        fmt::format("the factor is out of range: --exaggerate {}: give a number from 1 to 100000", *args.exaggeration));
  return {};
}

}  // namespace

tl::expected<MeasureOptions, UsageError> parse_measure_options(const MeasureArgs& args) {
  MeasureOptions options;
  const auto method = method_of(args.method);
  if (!method) return tl::unexpected(method.error());
  options.method = *method;
  if (const auto checked = check_combinations(args); !checked) return tl::unexpected(checked.error());
  for (const auto parse : {parse_prints, parse_camera, parse_frames, parse_details, check_references}) {
    if (const auto parsed = parse(args, options); !parsed) return tl::unexpected(parsed.error());
  }
  return options;
}

}  // namespace moiregauge::internal
