// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/live/live_args.h"

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/app/measure_options.h"
#include "moiregauge/base/duration_text.h"
#include "moiregauge/base/size_text.h"

namespace moiregauge::internal::cli {
namespace {

constexpr double kMaxPace = 1000.0;

tl::expected<std::optional<double>, UsageError> pace_of(const std::string& text) {
  if (text.empty()) return std::nullopt;
  if (text == "max") return 0.0;
  double pace = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), pace);
  if (error != std::errc() || end != text.data() + text.size() || !(pace > 0.0 && pace <= kMaxPace))
    return usage(fmt::format(
        "the pace is out of range: --pace {}: give a factor on the recording's speed, above 0 and up to 1000, or max",
        text));
  return pace;
}

// Reads a duration into `seconds`, if it is given.
tl::expected<void, UsageError> take_duration(const char* option, const std::string& text, double& seconds) {
  if (text.empty()) return {};
  const auto read = long_duration_s(text);
  if (!read) return usage(fmt::format("the time cannot be read: {} {}: {}", option, text, read.error()));
  if (!(*read > 0.0)) return usage(fmt::format("the time is zero: {} {}: give a longer one, e.g. 1h", option, text));
  seconds = *read;
  return {};
}

tl::expected<void, UsageError> take_quota(const std::string& text, std::uint64_t& bytes) {
  if (text.empty()) return {};
  if (const auto size = byte_count(text)) {
    bytes = *size;
    return {};
  }
  return usage(fmt::format("the quota cannot be read: --quota {}: write it like 500MB, 20GB or 2TB", text));
}

}  // namespace

tl::expected<LiveRequest, UsageError> live_request(const LiveArgs& args) {
  const MeasureArgs& measure = args.measure;
  auto options = parse_measure_options(measure);
  if (!options) return tl::unexpected(options.error());
  LiveRequest request;
  request.options = *std::move(options);
  const auto pace = pace_of(args.pace);
  if (!pace) return tl::unexpected(pace.error());
  request.pace = *pace;
  LiveStoreOptions& store = request.store;
  for (const auto& taken :
       {take_duration("--for", args.max_time, request.max_s), take_duration("--segment", args.segment, store.segment_s),
        take_duration("--keep", args.keep, store.keep_s), take_quota(args.quota, store.quota)}) {
    if (!taken) return tl::unexpected(taken.error());
  }
  const bool has_limit = !args.keep.empty() || !args.quota.empty();
  if (has_limit && !store.has_segments())
    return usage("--keep and --quota apply to segments only: live: add --segment, e.g. --segment 1h");
  if (store.has_segments() && measure.restart)
    return usage("--restart applies to a single run only: --segment: choose another folder with -o");
  request.source = measure.input;
  auto camera = camera_args(args.source);
  if (!camera) return tl::unexpected(camera.error());
  request.camera = *std::move(camera);
  if (!is_camera_source(measure.input)) {
    const std::string option = args.source.patience.empty() ? genicam_option(request.camera) : "--patience";
    if (!option.empty())
      return usage(fmt::format("{} applies to cameras only: {}: remove {}", option, measure.input, option));
  } else {
    CameraArgs whole = request.camera;
    whole.source = measure.input;
    whole.fps = measure.fps;
    if (const std::string problem = camera_args_problem(whole); !problem.empty()) return usage(problem);
  }
  request.input_options = {measure.fps, measure.slow_motion, measure.sequence, measure.threads, measure.max_pixels};
  const std::string name = is_camera_source(measure.input) ? "camera" : measure.input;
  store.folder = measure.output.empty() ? default_output(name, "-live") : measure.output;
  store.earlier = measure.resume ? Earlier::kResume : measure.restart ? Earlier::kRestart : Earlier::kAsk;
  return request;
}

}  // namespace moiregauge::internal::cli
