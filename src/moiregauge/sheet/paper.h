// SPDX-License-Identifier: Apache-2.0
// Paper sizes, and the area of a page for markers.
#pragma once

#include <optional>
#include <string>

#include "moiregauge/units/point.h"

namespace moiregauge::internal::sheet {

struct Paper {
  std::string name;  // "A3", "300 x 400 mm"
  double width_mm = 0.0;
  double height_mm = 0.0;
};

// Returns A0 to A5, letter, legal or tabloid in portrait. Ignores case.
[[nodiscard]] std::optional<Paper> standard_paper(const std::string& name);
[[nodiscard]] std::string standard_paper_names();  // "A0, A1, ..."

[[nodiscard]] Paper turned(const Paper& paper);

// Smallest width and height of paper, mm: rulers and text need the space.
inline constexpr double kSmallestPaper_mm = 90.0;
inline constexpr double kLargestPaper_mm = 5000.0;  // the limit of a PDF page: 200 inches

// Margins for rulers, texts and a printer's unprintable edge, mm.
struct Edges {
  double left = 19.0, right = 7.0, top = 15.0, bottom = 24.0;
};
inline constexpr Edges kEdges{};

// Returns the remaining width and height, mm.
[[nodiscard]] Extent<frame::Board> room_on(const Paper& paper);

}  // namespace moiregauge::internal::sheet
