// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/sheet_words.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "moiregauge/io/length_text.h"

namespace moiregauge::cli {
namespace {

tl::unexpected<UsageError> usage(std::string message) { return tl::unexpected(UsageError{std::move(message)}); }

constexpr int kMostTargets = 100;

// A length, where one is given.
tl::expected<double, UsageError> length_or(const char* option, const std::string& text, double otherwise) {
  if (text.empty()) return otherwise;
  const auto mm = length_mm(text);
  if (!mm) return usage(fmt::format("length: {} {}: {}", option, text, mm.error()));
  return *mm;
}

tl::expected<sheet::PageRequest, UsageError> page_of(const SheetWords& words) {
  sheet::PageRequest page;
  if (const auto known = sheet::standard_paper(words.paper)) {
    page.paper = *known;
  } else {
    const auto size = size_mm(words.paper);
    if (!size)
      return usage(fmt::format("paper: --paper {}: one of {}, or a size such as 300x400mm", words.paper,
                               sheet::standard_paper_names()));
    page.paper = {fmt::format("{:g} x {:g} mm", size->x, size->y), size->x, size->y};
  }
  const double smallest = std::min(page.paper.width_mm, page.paper.height_mm);
  if (smallest < sheet::kSmallestPaper_mm ||
      std::max(page.paper.width_mm, page.paper.height_mm) > sheet::kLargestPaper_mm)
    return usage(fmt::format("paper: --paper {}: sides from {:g} to {:g} mm", words.paper, sheet::kSmallestPaper_mm,
                             sheet::kLargestPaper_mm));
  if (words.orientation == "portrait")
    page.orientation = sheet::Orientation::kPortrait;
  else if (words.orientation == "landscape")
    page.orientation = sheet::Orientation::kLandscape;
  else if (words.orientation != "auto")
    return usage(
        fmt::format("orientation: --orientation {}: choose one of auto, portrait, landscape", words.orientation));
  if (words.separate) page.together = sheet::Together::kNever;
  return page;
}

tl::expected<sheet::Ink, UsageError> ink_of(const SheetWords& words) {
  if (!(words.ink_percent >= 10.0 && words.ink_percent <= 100.0))
    return usage(fmt::format("ink: --ink {:g}: per cent of black, 10 to 100", words.ink_percent));
  if (!(words.gamma >= 0.3 && words.gamma <= 4.0))
    return usage(fmt::format("gamma: --gamma {:g}: 0.3 to 4; 1 for video cameras and telephones, 2.2 for linear output",
                             words.gamma));
  return sheet::Ink{words.ink_percent / 100.0, words.inverted, words.gamma};
}

tl::expected<sheet::SetRequest, UsageError> request_of(const SheetWords& words, const sheet::PageRequest& page) {
  sheet::SetRequest request;
  const std::string pattern = words.pattern.empty() ? "grid" : words.pattern;
  const auto known = pattern_named(pattern);
  if (!known || *known == Pattern::kAuto)
    return usage(fmt::format(
        "pattern: --pattern {}: choose one of grid, squares, dots, lines-x, lines-y, checkerboard, cosine", pattern));
  request.pattern = *known;
  request.references = words.references.value_or(4);
  request.targets = words.targets.value_or(1);
  if (request.references != 4 && request.references != 6)
    return usage(fmt::format("references: --references {}: 4, or 6 (which can check each other)", request.references));
  if (request.targets < 0 || request.targets > kMostTargets)
    return usage(fmt::format("targets: --targets {}: 0 to {}", request.targets, kMostTargets));
  const struct {
    const char* option;
    const std::string& text;
    double& value;
  } lengths[] = {{"--pitch", words.pitch, request.pitch_mm},
                 {"--reference-size", words.reference_size, request.reference_size_mm},
                 {"--target-size", words.target_size, request.target_size_mm},
                 {"--circle", words.circle, request.circle_diameter_mm}};
  for (const auto& length : lengths) {
    const auto mm = length_or(length.option, length.text, length.value);
    if (!mm) return tl::unexpected(mm.error());
    length.value = *mm;
  }
  if (!words.span.empty()) {
    const auto span = size_mm(words.span);
    if (!span) return usage(fmt::format("span: --span {}: {}", words.span, span.error()));
    request.span = *span;
  } else if (words.separate) {
    return usage("--separate without --span: where the sheets are to hang is not known: give --span, e.g. 760x300mm");
  } else {
    request.span = sheet::widest_span(request, sheet::room_on(sheet::oriented(page, true)));
    if (!(request.span.x > 0.0 && request.span.y > 0.0))
      return usage(
          fmt::format("paper: {}: no room for prints of {:g} mm pitch: choose larger paper or a smaller --pitch",
                      page.paper.name, request.pitch_mm));
  }
  return request;
}

bool asks_for_a_layout(const SheetWords& words) {
  return !words.pitch.empty() || !words.pattern.empty() || !words.span.empty() || !words.reference_size.empty() ||
         !words.target_size.empty() || !words.circle.empty() || words.references || words.targets;
}

tl::expected<Site, UsageError> site_for(const SheetWords& words, const sheet::PageRequest& page) {
  if (!words.site.empty()) {
    if (asks_for_a_layout(words))
      return usage(
          "--site with a layout's options: the site file states pitch, pattern, sizes and places: leave those out");
    return site_of_file(words.site);
  }
  const auto request = request_of(words, page);
  if (!request) return tl::unexpected(request.error());
  auto site = sheet::site_of_set(*request);
  if (!site) return usage("layout: " + site.error());
  // A printer's scale is not known before its rulers are measured: two in three are within 0.1 %.
  site->known_to.print_scale = 0.001;
  return *std::move(site);
}

}  // namespace

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

tl::expected<SheetOrder, UsageError> understood(const SheetWords& words) {
  const auto page = page_of(words);
  if (!page) return tl::unexpected(page.error());
  const auto ink = ink_of(words);
  if (!ink) return tl::unexpected(ink.error());
  auto site = site_for(words, *page);
  if (!site) return tl::unexpected(site.error());
  return SheetOrder{*std::move(site), *page, *ink};
}

}  // namespace moiregauge::cli
