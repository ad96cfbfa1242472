// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/sheet/paper.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace moiregauge::internal::sheet {
namespace {

struct Size {
  const char* name;
  double width_mm, height_mm;
};

// ISO 216. North American sizes are multiples of half an inch.
constexpr std::array kSizes{
    Size{"A0", 841, 1189},        Size{"A1", 594, 841},        Size{"A2", 420, 594},
    Size{"A3", 297, 420},         Size{"A4", 210, 297},        Size{"A5", 148, 210},
    Size{"letter", 215.9, 279.4}, Size{"legal", 215.9, 355.6}, Size{"tabloid", 279.4, 431.8},
};

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

std::optional<Paper> standard_paper(const std::string& name) {
  for (const Size& size : kSizes) {
    if (lower(size.name) == lower(name)) return Paper{size.name, size.width_mm, size.height_mm};
  }
  return std::nullopt;
}

std::string standard_paper_names() {
  std::string names;
  for (const Size& size : kSizes) names += (names.empty() ? "" : ", ") + std::string(size.name);
  return names;
}

Paper turned(const Paper& paper) { return {paper.name, paper.height_mm, paper.width_mm}; }

Extent<frame::Board> room_on(const Paper& paper) {
  return {paper.width_mm - kEdges.left - kEdges.right, paper.height_mm - kEdges.top - kEdges.bottom};
}

}  // namespace moiregauge::internal::sheet
