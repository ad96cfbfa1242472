// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/measure.h"

#include <utility>

#include "moiregauge/app/frame_range_text.h"
#include "moiregauge/app/open_input.h"
#include "moiregauge/library/convert.h"

namespace moiregauge {
namespace {

internal::RunCallbacks callbacks_of(const MeasureOptions& options) {
  internal::RunCallbacks callbacks;
  if (options.on_progress)
    callbacks.on_progress = [&options](const internal::RunProgress& p) {
      return options.on_progress(p.done, p.expected);
    };
  return callbacks;
}

internal::Earlier earlier_of(Unfinished unfinished) {
  switch (unfinished) {
    case Unfinished::kResume:
      return internal::Earlier::kResume;
    case Unfinished::kRestart:
      return internal::Earlier::kRestart;
    case Unfinished::kRefuse:
      break;
  }
  return internal::Earlier::kAsk;
}

// Measures without writing anything.
Expected<Result> measure_in_memory(const internal::RunRequest& request, const MeasureOptions& options) {
  const auto open = [&] { return internal::open_input(request.input, request.input_options); };
  const auto on_progress = [&](long done, long expected) {
    return !options.on_progress || options.on_progress(done, expected);
  };
  const auto measured = internal::measure(open, request.options, on_progress);
  if (!measured) return internal::public_error(internal::Exit::kInputUnreadable, measured.error().message);
  if (!measured->contradiction.empty())
    return internal::public_error(internal::Exit::kUsage, measured->contradiction + ": correct the option");
  return internal::to_result(*measured, request.options);
}

}  // namespace

const char* to_string(Status status) {
  constexpr const char* kWords[] = {
      "ok",   "untrusted",      "camera-moved",   "blurred",      "saturated", "partly-covered",
      "lost", "reference-lost", "order-unproven", "decode-error", "too-coarse"};
  return kWords[static_cast<std::size_t>(status)];
}

Expected<FrameRange> read_frame_range(const std::string& text, const std::string& option) {
  const auto range = internal::frame_range_in(text, {option.c_str(), "0:20", option == internal::kFramesOption.name});
  if (!range) return internal::public_error(internal::Exit::kUsage, range.error().message);
  FrameRange out{range->first, range->end, range->step};
  if (range->seconds) out.time = TimeRange{Seconds(range->seconds->first_s), Seconds(range->seconds->end_s)};
  return out;
}

Expected<Result> measure(const std::string& input, const MeasureOptions& options) {
  auto wanted = internal::to_internal(options);
  if (!wanted) return tl::unexpected(wanted.error());
  internal::RunRequest request;
  request.input = input;
  request.input_options.fps = options.fps;
  request.input_options.slow_motion = options.slow_motion;
  request.input_options.threads = options.threads;
  request.options = *std::move(wanted);
  request.output = options.output;
  request.earlier = earlier_of(options.unfinished);
  if (request.output.empty()) return measure_in_memory(request, options);
  const internal::RunCallbacks callbacks = callbacks_of(options);
  const auto finished = internal::run_measurement(request, callbacks);
  if (!finished) return internal::public_error(finished.error().exit, finished.error().message);
  Result result = internal::to_result(finished->measurement, request.options);
  result.folder = finished->folder;
  return result;
}

}  // namespace moiregauge
