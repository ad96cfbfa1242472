// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/common/layout_args.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "moiregauge/base/length_text.h"

namespace moiregauge::internal::cli {
namespace {

constexpr int kMaxTargets = 100;
// Limits of lengths: finer than any printer, larger than any structure.
constexpr double kMinLength_mm = 0.01;
constexpr double kMaxLength_mm = 1e6;
constexpr int kDefaultReferences = 6, kFewestReferences = 4;
constexpr double kUnmeasuredPrintScale = 0.001;  // relative, k = 1

tl::expected<sheet::SetRequest, UsageError> request_of(const LayoutArgs& args, const Room& room) {
  sheet::SetRequest request;
  const std::string pattern = args.pattern.empty() ? "grid" : args.pattern;
  const auto known = pattern_named(pattern);
  if (!known || *known == Pattern::kAuto)
    return usage(fmt::format(
        "the pattern is unknown: --pattern {}: choose one of grid, squares, dots, lines-x, lines-y, checkerboard, "
        "cosine",
        pattern));
  request.pattern = *known;
  request.references = args.references.value_or(kDefaultReferences);
  request.targets = args.targets.value_or(1);
  if (request.references != 4 && request.references != 6)
    return usage(
        fmt::format("a layout has 4 or 6 references: --references {}: give 4, or 6 so that they can check each other",
                    request.references));
  if (request.targets < 1 || request.targets > kMaxTargets)
    return usage(
        fmt::format("the number of targets is out of range: --targets {}: give 1 to {}", request.targets, kMaxTargets));
  const struct {
    const char* option;
    const std::string& text;
    double& value;
  } lengths[] = {{"--pitch", args.pitch, request.pitch_mm},
                 {"--reference-size", args.reference_size, request.reference_size_mm},
                 {"--target-size", args.target_size, request.target_size_mm},
                 {"--circle", args.circle, request.circle_diameter_mm}};
  for (const auto& length : lengths) {
    const auto mm = length_or(length.option, length.text, length.value);
    if (!mm) return tl::unexpected(mm.error());
    if (!length.text.empty() && !(*mm >= kMinLength_mm && *mm <= kMaxLength_mm))
      return usage(fmt::format("the length is out of range: {} {}: give {:g} to {:g} mm", length.option, length.text,
                               kMinLength_mm, kMaxLength_mm));
    length.value = *mm;
  }
  if (!args.span.empty()) {
    const auto span = size_mm(args.span);
    if (!span) return usage(fmt::format("the span cannot be read: --span {}: {}", args.span, span.error()));
    if (!(std::max(span->x, span->y) <= kMaxLength_mm))
      return usage(
          fmt::format("the span is too large: --span {}: give up to {:g} mm each way", args.span, kMaxLength_mm));
    request.span = *span;
  } else {
    request.span = sheet::widest_span(request, room.size);
    if (!(request.span.x > 0.0 && request.span.y > 0.0))
      return usage(fmt::format("gratings of {:g} mm pitch do not fit: {}: choose a larger area or a smaller --pitch",
                               request.pitch_mm, room.name));
  }
  return request;
}

bool asks_for_a_layout(const LayoutArgs& args) {
  return !args.pitch.empty() || !args.pattern.empty() || !args.span.empty() || !args.reference_size.empty() ||
         !args.target_size.empty() || !args.circle.empty() || args.references || args.targets;
}

}  // namespace

void add_layout_options(CLI::App& command, LayoutArgs& args) {
  command.add_option("--pitch", args.pitch, "pitch of the gratings with its unit [10mm]")->type_name("LENGTH");
  command.add_option("--pattern", args.pattern, "grid, squares, dots, lines-x, lines-y, checkerboard or cosine [grid]")
      ->type_name("NAME");
  command.add_option("--references", args.references, "4, or 6 so that they can check each other [6 if they fit]")
      ->type_name("N");
  command.add_option("--targets", args.targets, "number of targets, in a row at half height [1]")->type_name("N");
  command.add_option("--span", args.span, "distance between the outermost circles, e.g. 760x300mm [the whole area]")
      ->type_name("WxH");
  command.add_option("--reference-size", args.reference_size, "side of a reference's grating [4 pitches]")
      ->type_name("LENGTH");
  command.add_option("--target-size", args.target_size, "side of a target's grating [6 pitches]")->type_name("LENGTH");
  command.add_option("--circle", args.circle, "diameter of the circles [2 pitches]")->type_name("LENGTH");
  command.add_option("--site", args.site, "use the markers of this site.toml instead")->type_name("FILE");
}

tl::expected<double, UsageError> length_or(const char* option, const std::string& text, double otherwise) {
  if (text.empty()) return otherwise;
  const auto mm = length_mm(text);
  if (!mm) return usage(fmt::format("the length cannot be read: {} {}: {}", option, text, mm.error()));
  return *mm;
}

tl::expected<Extent<frame::Board>, std::string> size_mm(const std::string& text) {
  const std::string how = "write width x height with a unit, e.g. 760x56mm";
  const auto cross = text.find('x');
  if (cross == std::string::npos || text.find('x', cross + 1) != std::string::npos) return tl::unexpected(how);
  std::string width = text.substr(0, cross);
  const std::string height = text.substr(cross + 1);
  const auto ends_in_unit = [](const std::string& t) {
    const auto last = t.find_last_not_of(' ');
    return last != std::string::npos && std::isdigit(static_cast<unsigned char>(t[last])) == 0 && t[last] != '.';
  };
  if (!ends_in_unit(width)) {
    const auto unit = height.find_last_of("0123456789.");
    if (unit == std::string::npos) return tl::unexpected(how);
    width += height.substr(unit + 1);
  }
  const auto x = length_mm(width), y = length_mm(height);
  if (!x || !y) return tl::unexpected(how);
  return Extent<frame::Board>{*x, *y};
}

tl::expected<MarkerLayout, UsageError> site_of_layout(const LayoutArgs& args, const Room& room) {
  if (!args.site.empty()) {
    if (asks_for_a_layout(args))
      return usage(
          "--site excludes the layout options: the site file states pitch, pattern, sizes and positions: remove those "
          "options");
    auto site = site_of_file(args.site);
    if (!site) return tl::unexpected(site.error());
    return MarkerLayout{*std::move(site), {}, std::nullopt};
  }
  auto request = request_of(args, room);
  if (!request) return tl::unexpected(request.error());
  MarkerLayout layout;
  auto site = sheet::site_of_set(*request);
  if (!site && request->references == kDefaultReferences) {
    const auto pitch = sheet::fitting_pitch(*request, args.span.empty() ? std::optional(room.size) : std::nullopt);
    const std::string fitting = pitch ? fmt::format("six references fit with --pitch {:g}mm or less ({})", *pitch,
                                                    args.span.empty() ? room.name : "--span " + args.span)
                                      : "six references need a wider --span or a larger area";
    if (args.references) return usage(fmt::format("layout: {}; {}", site.error(), fitting));
    request->references = kFewestReferences;
    site = sheet::site_of_set(*request);
    layout.note = fmt::format("there are four references, which cannot show which one moves: {}", fitting);
  }
  if (!site) return usage("layout: " + site.error());
  layout.site = *std::move(site);
  // The scale of a printer is unknown before its rulers are measured.
  layout.site.known_to.print_scale = kUnmeasuredPrintScale;
  layout.request = *request;
  return layout;
}

}  // namespace moiregauge::internal::cli
