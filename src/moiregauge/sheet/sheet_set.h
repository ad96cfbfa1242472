// SPDX-License-Identifier: Apache-2.0
// Arranges a site's markers on sheets of paper: all on one if they fit, otherwise one per sheet.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/sheet/paper.h"
#include "moiregauge/sheet/set_layout.h"

namespace moiregauge::internal::sheet {

enum class Orientation { kAuto, kPortrait, kLandscape };
enum class Together { kWhereTheyFit, kNever };

// Parts in which a sheet that is larger than the paper is printed. They are of equal size and overlap by `overlap_mm`.
struct Tiling {
  Paper paper;  // in its orientation
  int columns = 1, rows = 1;
  double width_mm = 0.0, height_mm = 0.0;  // size of a part
};
inline constexpr double kTileOverlap_mm = 10.0;  // strip for glue; half of it is cut off
inline constexpr int kMaxTiles = 64;             // largest number of parts of one marker; chosen

// One page, at scale 1:1. Its markers keep their relative positions, x to the right, y upwards. The board point
// `middle` is the centre of the area inside the margins.
struct Sheet {
  std::string name;  // "NW", or "set" if all markers are on it
  Paper paper;       // in its orientation
  std::vector<Marker> markers;
  BoardPoint middle;
  double cut_mm = 0.0;           // white margin around a marker that is cut out
  std::optional<Tiling> tiling;  // the page is larger than the paper
};

struct SheetSet {
  Site site;  // site as printed, to the last bit
  std::vector<Sheet> sheets;
};

struct PageRequest {
  Paper paper;
  Orientation orientation = Orientation::kAuto;
  Together together = Together::kWhereTheyFit;
};

// Returns the paper in the requested orientation. kAuto: that of the printed area.
[[nodiscard]] Paper oriented(const PageRequest& page, bool is_wide);

// Returns the sheets. A marker that is larger than the paper is printed in parts. Fails if a circle has no diameter,
// markers overlap, a marker needs more than kMaxTiles parts, or a cosine grating needs parts.
[[nodiscard]] tl::expected<SheetSet, std::string> sheets_of(const Site& site, const PageRequest& page);

// Position on the page, mm from its upper left corner, y downwards.
struct PagePoint {
  double x_mm = 0.0, y_mm = 0.0;
};
[[nodiscard]] PagePoint on_page(const Sheet& sheet, BoardPoint p);

}  // namespace moiregauge::internal::sheet
