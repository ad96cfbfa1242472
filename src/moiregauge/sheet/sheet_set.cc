// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/sheet/sheet_set.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace moiregauge::internal::sheet {
namespace {

constexpr double kRounding_mm = 1e-6;

// Returns the reason why a site cannot be printed, or nothing.
std::optional<std::string> unprintable(const Site& site) {
  for (const Marker& marker : site.markers) {
    if (marker.circle && !(marker.circle->diameter_mm > 0.0))
      return fmt::format("the circle of '{}' has no circle_diameter_mm, add it to the site file", marker.name);
  }
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    for (std::size_t k = i + 1; k < site.markers.size(); ++k) {
      if (gap_between(extent_of(site.markers[i]), extent_of(site.markers[k])) < 0.0)
        return fmt::format("'{}' and '{}' overlap, move them apart", site.markers[i].name, site.markers[k].name);
    }
  }
  return std::nullopt;
}

// Replaces kAuto, which only detection knows, by a pattern that can be printed.
void choose_patterns(Site& site) {
  for (Marker& marker : site.markers) {
    if (marker.grating && marker.grating->pattern == Pattern::kAuto) marker.grating->pattern = Pattern::kGrid;
  }
}

// Returns the white margin that is possible around every marker, mm.
double cut_of(const Site& site) {
  double cut = 1e9;
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    cut = std::min(cut, quiet_zone_mm(site.markers[i]));
    for (std::size_t k = i + 1; k < site.markers.size(); ++k)
      cut = std::min(cut, 0.5 * gap_between(extent_of(site.markers[i]), extent_of(site.markers[k])));
  }
  return cut;
}

bool fits(const Box& box, double cut_mm, const Paper& paper) {
  const auto room = room_on(paper);
  return box.width() + 2.0 * cut_mm <= room.x + kRounding_mm && box.height() + 2.0 * cut_mm <= room.y + kRounding_mm;
}

std::optional<Sheet> one_sheet(const std::string& name, const std::vector<Marker>& markers, double cut_mm,
                               const PageRequest& page) {
  const Box box = extent_of(markers);
  const Paper first = oriented(page, box.width() > box.height());
  if (fits(box, cut_mm, first)) return Sheet{name, first, markers, box.middle(), cut_mm, std::nullopt};
  const Paper other = oriented(page, box.width() <= box.height());
  if (fits(box, cut_mm, other)) return Sheet{name, other, markers, box.middle(), cut_mm, std::nullopt};
  return std::nullopt;
}

// Returns the parts for an area of this size.
Tiling tiling_on(const Paper& paper, Extent<frame::Board> area) {
  const auto room = room_on(paper);
  const auto count = [](double whole, double part) {
    return std::max(1, static_cast<int>(std::ceil((whole - kTileOverlap_mm) / (part - kTileOverlap_mm) - 1e-9)));
  };
  Tiling tiling{paper, count(area.x, room.x), count(area.y, room.y), 0.0, 0.0};
  tiling.width_mm = (area.x + (tiling.columns - 1) * kTileOverlap_mm) / tiling.columns;
  tiling.height_mm = (area.y + (tiling.rows - 1) * kTileOverlap_mm) / tiling.rows;
  return tiling;
}

// Returns the sheet of a marker that is larger than the paper. Nothing: it needs too many parts.
std::optional<Sheet> tiled_sheet(const Marker& marker, double cut_mm, const PageRequest& page) {
  const Box box = extent_of(marker);
  const Extent<frame::Board> area{box.width() + 2.0 * cut_mm, box.height() + 2.0 * cut_mm};
  Tiling best = tiling_on(oriented(page, true), area);
  const Tiling upright = tiling_on(oriented(page, false), area);
  if (upright.columns * upright.rows < best.columns * best.rows) best = upright;
  if (static_cast<double>(best.columns) * best.rows > kMaxTiles) return std::nullopt;
  const Paper whole{fmt::format("{:.0f} x {:.0f} mm", area.x, area.y), area.x + kEdges.left + kEdges.right,
                    area.y + kEdges.top + kEdges.bottom};
  return Sheet{marker.name, whole, {marker}, box.middle(), cut_mm, best};
}

}  // namespace

Paper oriented(const PageRequest& page, bool is_wide) {
  const bool lies = page.paper.width_mm > page.paper.height_mm;
  const bool should_lie =
      page.orientation == Orientation::kLandscape || (page.orientation == Orientation::kAuto && is_wide);
  return lies == should_lie ? page.paper : turned(page.paper);
}

tl::expected<SheetSet, std::string> sheets_of(const Site& site, const PageRequest& page) {
  if (const auto problem = unprintable(site)) return tl::unexpected(*problem);
  SheetSet set{site, {}};
  choose_patterns(set.site);
  const double cut = cut_of(set.site);
  if (page.together == Together::kWhereTheyFit) {
    if (auto sheet = one_sheet("set", set.site.markers, cut, page)) {
      set.sheets.push_back(*std::move(sheet));
      return set;
    }
  }
  for (const Marker& marker : set.site.markers) {
    auto sheet = one_sheet(marker.name, {marker}, cut, page);
    const bool is_cosine = marker.grating && marker.grating->pattern == Pattern::kCosine;
    if (!sheet && !is_cosine) sheet = tiled_sheet(marker, cut, page);
    if (!sheet) {
      const Box box = extent_of(marker);
      const auto room = room_on(oriented(page, box.width() > box.height()));
      return tl::unexpected(fmt::format(
          "'{}' needs {:.0f} x {:.0f} mm with its white border, {} has room for {:.0f} x {:.0f}{}, choose a larger "
          "--paper or a smaller grating",
          marker.name, box.width() + 2.0 * cut, box.height() + 2.0 * cut, page.paper.name, room.x, room.y,
          is_cosine ? " and cosine gratings are not printed in parts"
                    : fmt::format(" and {} parts are too few", kMaxTiles)));
    }
    set.sheets.push_back(*std::move(sheet));
  }
  return set;
}

PagePoint on_page(const Sheet& sheet, BoardPoint p) {
  const auto room = room_on(sheet.paper);
  return {kEdges.left + 0.5 * room.x + p.x - sheet.middle.x, kEdges.top + 0.5 * room.y - (p.y - sheet.middle.y)};
}

}  // namespace moiregauge::internal::sheet
