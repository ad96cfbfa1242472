// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/site/site.h"

#include <array>
#include <cmath>
#include <utility>

namespace moiregauge::internal {
namespace {

constexpr std::array<std::pair<Pattern, const char*>, 8> kPatternWords{{
    {Pattern::kAuto, "auto"},
    {Pattern::kGrid, "grid"},
    {Pattern::kSquares, "squares"},
    {Pattern::kDots, "dots"},
    {Pattern::kLinesX, "lines-x"},
    {Pattern::kLinesY, "lines-y"},
    {Pattern::kCheckerboard, "checkerboard"},
    {Pattern::kCosine, "cosine"},
}};

}  // namespace

std::optional<Extent<frame::Board>> direction_of_lines(const Grating& grating) {
  const double c = std::cos(grating.angle_rad), s = std::sin(grating.angle_rad);
  if (grating.pattern == Pattern::kLinesX) return Extent<frame::Board>{-s, c};
  if (grating.pattern == Pattern::kLinesY) return Extent<frame::Board>{c, s};
  return std::nullopt;
}

const char* word_for(Pattern pattern) {
  for (const auto& [value, word] : kPatternWords) {
    if (value == pattern) return word;
  }
  return "auto";
}

std::optional<Pattern> pattern_named(const std::string& word) {
  for (const auto& [value, name] : kPatternWords) {
    if (word == name) return value;
  }
  return std::nullopt;
}

}  // namespace moiregauge::internal
