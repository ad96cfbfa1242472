// SPDX-License-Identifier: Apache-2.0
// A site's markers on sheets of paper: all on one where they fit, else one a sheet.
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

// One page. Its markers keep their places to one another: the board point `middle` lies in the middle of the room that
// the page's edges leave, x to the right, y up, a board's millimetre a millimetre of paper.
struct Sheet {
  std::string name;  // "NW", or "set" when all are on it
  Paper paper;       // as it is to lie
  std::vector<Marker> markers;
  BoardPoint middle;
  double cut_mm = 0.0;  // white to leave round a marker when it is cut out
};

struct SheetSet {
  Site site;  // what the prints are, to the last bit
  std::vector<Sheet> sheets;
};

struct PageRequest {
  Paper paper;
  Orientation orientation = Orientation::kAuto;
  Together together = Together::kWhereTheyFit;
};

// The paper as `orientation` wants it; `kAuto`: lying as what is printed on it does.
[[nodiscard]] Paper oriented(const PageRequest& page, bool is_wide);

// fails   where a circle's diameter is not stated, prints overlap, or a marker is larger than the paper
[[nodiscard]] tl::expected<SheetSet, std::string> sheets_of(const Site& site, const PageRequest& page);

// Where on the page, in mm from its upper left corner, y downwards, a board point is printed.
struct PagePoint {
  double x_mm = 0.0, y_mm = 0.0;
};
[[nodiscard]] PagePoint on_page(const Sheet& sheet, BoardPoint p);

}  // namespace moiregauge::internal::sheet
