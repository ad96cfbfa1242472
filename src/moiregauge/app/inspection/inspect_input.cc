// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/inspection/inspect_input.h"

#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/app/inspect_frame.h"
#include "moiregauge/app/open_input.h"
#include "moiregauge/drawing/overlays/overlay_inspection.h"
#include "moiregauge/image/upper_bits.h"

namespace moiregauge::internal {
namespace {

tl::unexpected<RunFailure> cannot_inspect(Exit exit, std::string message) {
  return tl::unexpected(RunFailure{exit, std::move(message)});
}

// Returns the frame with that number. It is valid until the next call of the source.
tl::expected<Frame, RunFailure> frame_of(FrameSource& source, long number,
                                         const std::function<void(long, long)>& on_progress) {
  long seen = 0;
  while (true) {
    auto frame = source.next();
    if (!frame) return cannot_inspect(Exit::kInputUnreadable, frame.error().message);
    const std::string& path = source.info().path;
    if (!*frame) {
      if (seen == 0)
        return cannot_inspect(Exit::kInputUnreadable,
                              fmt::format("the input has no frames: {}: give a video or images", path));
      return cannot_inspect(Exit::kUsage,
                            fmt::format("the selected frame does not exist: --frame {} of {}: choose from its {}, the "
                                        "first is 0",
                                        number, path, seen == 1 ? "1 frame" : fmt::format("{} frames", seen)));
    }
    if ((*frame)->number == number && (*frame)->damaged)
      return cannot_inspect(
          Exit::kInputUnreadable,
          fmt::format("the frame is damaged: {}, frame {}: choose another with --frame", path, number));
    if ((*frame)->number == number) return **frame;
    seen = (*frame)->number + 1;
    if (on_progress) on_progress(seen, number + 1);
  }
}

// `frame` of the source is invalid afterwards.
std::optional<QuantiserMap> next_quantiser(FrameSource& source) {
  const auto next = source.next();
  if (!next || !*next) return std::nullopt;
  return (*next)->quantiser;
}

}  // namespace

tl::expected<InspectOptions, UsageError> inspect_options(const InspectArgs& args) {
  if (args.frame < 0)
    return usage(
        fmt::format("the frame number is negative: --frame {}: give a frame of the input, the first is 0", args.frame));
  return parse_inspect_options(args.measure);
}

tl::expected<InspectedFrame, RunFailure> inspect_input(const InspectArgs& args, const InspectOptions& options,
                                                       const std::function<void(long, long)>& on_progress) {
  const MeasureArgs& how = args.measure;
  const auto source = open_input(how.input, {how.fps, {}, how.sequence, how.threads, how.max_pixels});
  if (!source) return cannot_inspect(Exit::kInputUnreadable, source.error().message);
  const InputInfo& input = (*source)->info();
  if (const auto problem = camera_problem(options.lens, input)) return cannot_inspect(Exit::kUsage, *problem);
  const auto frame = frame_of(**source, args.frame, on_progress);
  if (!frame) return tl::unexpected(frame.error());
  Image<std::uint8_t> grey = upper_bits(frame->luma, input.bits);
  InspectedFrame out{inspect_frame(input, *frame, options, [&] { return next_quantiser(**source); }), std::move(grey)};
  if (out.report.seen.is_choice_unknown) return cannot_inspect(Exit::kUsage, out.report.seen.missing);
  return out;
}

tl::expected<InspectedFrame, RunFailure> inspect_image(const GreyPicture& picture, const std::string& name,
                                                       const InspectOptions& options) {
  InputInfo input;
  input.path = name;
  input.frames = 1;
  input.width = width_of(picture.luma);
  input.height = height_of(picture.luma);
  input.bits = picture.bits;
  if (const auto problem = camera_problem(options.lens, input)) return cannot_inspect(Exit::kUsage, *problem);
  const Frame frame{.time_s = kNotMeasured, .luma = picture.luma};
  InspectedFrame out{inspect_frame(input, frame, options, [] { return std::optional<QuantiserMap>(); }),
                     upper_bits(picture.luma, picture.bits)};
  if (out.report.seen.is_choice_unknown) return cannot_inspect(Exit::kUsage, out.report.seen.missing);
  return out;
}

std::vector<std::uint8_t> overlay_of_inspection(const InspectedFrame& inspected) {
  const InspectReport& report = inspected.report;
  const std::string caption =
      fmt::format("{}, frame {}: {} x {} px", report.input.path, report.frame, report.seen.width, report.seen.height);
  return draw_inspection({inspected.grey.view(), report.seen, report.expected, caption});
}

std::string inspect_json_text(const InspectReport& report) {
  return inspect_json(report).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace moiregauge::internal
