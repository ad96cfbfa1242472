// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/plan/sheet_args.h"

#include <algorithm>

#include <fmt/format.h>

namespace moiregauge::internal::cli {
namespace {

tl::expected<sheet::PageRequest, UsageError> page_of(const SheetArgs& args) {
  sheet::PageRequest page;
  if (const auto known = sheet::standard_paper(args.paper)) {
    page.paper = *known;
  } else {
    const auto size = size_mm(args.paper);
    if (!size)
      return usage(fmt::format("the paper is unknown: --paper {}: choose one of {}, or a size such as 300x400mm",
                               args.paper, sheet::standard_paper_names()));
    page.paper = {fmt::format("{:g} x {:g} mm", size->x, size->y), size->x, size->y};
  }
  const double smallest = std::min(page.paper.width_mm, page.paper.height_mm);
  if (smallest < sheet::kSmallestPaper_mm ||
      std::max(page.paper.width_mm, page.paper.height_mm) > sheet::kLargestPaper_mm)
    return usage(fmt::format("the paper's size is out of range: --paper {}: give sides of {:g} to {:g} mm", args.paper,
                             sheet::kSmallestPaper_mm, sheet::kLargestPaper_mm));
  if (args.orientation == "portrait")
    page.orientation = sheet::Orientation::kPortrait;
  else if (args.orientation == "landscape")
    page.orientation = sheet::Orientation::kLandscape;
  else if (args.orientation != "auto")
    return usage(fmt::format("the orientation is unknown: --orientation {}: choose one of auto, portrait, landscape",
                             args.orientation));
  if (args.separate) page.together = sheet::Together::kNever;
  return page;
}

tl::expected<sheet::Ink, UsageError> ink_of(const SheetArgs& args) {
  if (!(args.ink_percent >= 10.0 && args.ink_percent <= 100.0))
    return usage(
        fmt::format("the darkness is out of range: --ink {:g}: give 10 to 100 per cent of black", args.ink_percent));
  if (!(args.gamma >= 0.3 && args.gamma <= 4.0))
    return usage(fmt::format(
        "the exponent is out of range: --gamma {:g}: give 0.3 to 4 (video cameras and phones 1, linear output 2.2)",
        args.gamma));
  return sheet::Ink{args.ink_percent / 100.0, args.inverted, args.gamma};
}

}  // namespace

tl::expected<SheetOrder, UsageError> parse_sheet_options(const SheetArgs& args) {
  const auto page = page_of(args);
  if (!page) return tl::unexpected(page.error());
  const auto ink = ink_of(args);
  if (!ink) return tl::unexpected(ink.error());
  if (args.separate && args.layout.site.empty() && args.layout.span.empty())
    return usage("the positions of separate sheets are unknown: --separate: add --span, e.g. --span 760x300mm");
  auto layout = site_of_layout(args.layout, {page->paper.name, sheet::room_on(sheet::oriented(*page, true))});
  if (!layout) return tl::unexpected(layout.error());
  return SheetOrder{std::move(layout->site), *page, *ink, std::move(layout->note)};
}

}  // namespace moiregauge::internal::cli
