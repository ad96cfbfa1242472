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

// One page, at scale 1:1. Its markers keep their relative positions, x to the right, y upwards. The board point
// `middle` is the centre of the area inside the margins.
struct Sheet {
  std::string name;  // "NW", or "set" if all markers are on it
  Paper paper;       // in its orientation
  std::vector<Marker> markers;
  BoardPoint middle;
  double cut_mm = 0.0;  // white margin around a marker that is cut out
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

// Returns the sheets. Fails if a circle has no diameter, markers overlap, or a marker is larger than the paper.
[[nodiscard]] tl::expected<SheetSet, std::string> sheets_of(const Site& site, const PageRequest& page);

// Position on the page, mm from its upper left corner, y downwards.
struct PagePoint {
  double x_mm = 0.0, y_mm = 0.0;
};
[[nodiscard]] PagePoint on_page(const Sheet& sheet, BoardPoint p);

}  // namespace moiregauge::internal::sheet
