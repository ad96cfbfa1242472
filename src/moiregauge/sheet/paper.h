// SPDX-License-Identifier: Apache-2.0
// Sheets of paper, and how much of one is left for markers.
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

// A0 to A5, letter, legal, tabloid; capitals do not matter. Upright.
[[nodiscard]] std::optional<Paper> standard_paper(const std::string& name);
[[nodiscard]] std::string standard_paper_names();  // "A0, A1, ..."

[[nodiscard]] Paper turned(const Paper& paper);

// Smaller ones have no room for rulers and words.
inline constexpr double kSmallestPaper_mm = 90.0;
inline constexpr double kLargestPaper_mm = 5000.0;  // a PDF's page ends at 200 inches

// Room that rulers, words and a printer's unprintable edge take.
struct Edges {
  double left = 19.0, right = 7.0, top = 15.0, bottom = 24.0;
};
inline constexpr Edges kEdges{};

// What is left, mm.
[[nodiscard]] Extent<frame::Board> room_on(const Paper& paper);

}  // namespace moiregauge::internal::sheet
