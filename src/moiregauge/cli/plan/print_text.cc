// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/plan/print_text.h"

#include <algorithm>

#include <fmt/format.h>

#include "moiregauge/sheet/sheet_set.h"

namespace moiregauge::internal::cli {
namespace {

constexpr const char* kSmallPaper = "A4";

std::size_t pages_of(const sheet::SheetSet& set) {
  std::size_t pages = 0;
  for (const sheet::Sheet& sheet : set.sheets)
    pages += sheet.tiling ? static_cast<std::size_t>(sheet.tiling->columns * sheet.tiling->rows) : 1U;
  return pages;
}

bool is_in_parts(const sheet::SheetSet& set) {
  return std::ranges::any_of(set.sheets, [](const sheet::Sheet& sheet) { return sheet.tiling.has_value(); });
}

}  // namespace

PaperNeed paper_need(const Site& site) {
  PaperNeed need;
  for (const char* name : {"A4", "A3", "A2", "A1", "A0"}) {
    const auto set = sheet::sheets_of(site, {*sheet::standard_paper(name)});
    if (!set) continue;
    if (name == std::string(kSmallPaper)) need.a4_parts = pages_of(*set);
    if (is_in_parts(*set)) continue;
    need.paper = name;
    need.sheets = set->sheets.size();
    break;
  }
  return need;
}

std::string sheet_command(const PlanOrder& order, const std::string& paper) {
  if (!order.request) return fmt::format("moiregauge sheet --site {} --paper {}", order.site_file, paper);
  const sheet::SetRequest& r = *order.request;
  std::string text = fmt::format("moiregauge sheet --pitch {:g}mm --span {:g}x{:g}mm --references {} --targets {}",
                                 r.pitch_mm, r.span.x, r.span.y, r.references, r.targets);
  if (r.pattern != Pattern::kGrid) text += fmt::format(" --pattern {}", word_for(r.pattern));
  const std::pair<const char*, double> sizes[] = {{"--reference-size", r.reference_size_mm},
                                                  {"--target-size", r.target_size_mm},
                                                  {"--circle", r.circle_diameter_mm}};
  for (const auto& [option, mm] : sizes) {
    if (mm > 0.0) text += fmt::format(" {} {:g}mm", option, mm);
  }
  return text + " --paper " + paper;
}

std::string pitch_text(const PlanOrder& order) {
  const double scale = px_per_mm(order.setup);
  const std::string good =
      fmt::format("{:.3g} to {:.3g} mm are {:g} to {:g} px at this distance", kFinestGoodPitch_px / scale,
                  kCoarsestGoodPitch_px / scale, kFinestGoodPitch_px, kCoarsestGoodPitch_px);
  return order.is_pitch_chosen && order.request
             ? fmt::format("{:g} mm, chosen without --pitch; {}", order.request->pitch_mm, good)
             : good;
}

std::string paper_text(const PlanOrder& order) {
  const PaperNeed need = paper_need(order.setup.site);
  if (need.paper.empty() && need.a4_parts == 0) return "the markers do not fit on any paper, not even in parts";
  const std::string parts = need.paper == kSmallPaper || need.a4_parts == 0
                                ? ""
                                : fmt::format("{} pages of A4, larger markers in parts to join", need.a4_parts);
  const std::string whole =
      need.paper.empty()
          ? ""
          : fmt::format("{} of {}", need.sheets == 1 ? "one sheet" : fmt::format("{} sheets", need.sheets), need.paper);
  const std::string chosen = need.paper.empty() ? kSmallPaper : need.paper;
  return fmt::format("{}{}{}: {}", whole, whole.empty() || parts.empty() ? "" : ", or ", parts,
                     sheet_command(order, chosen));
}

}  // namespace moiregauge::internal::cli
