// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/identity/layout_symmetry.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace moiregauge::internal {
namespace {

// Tolerances of the identification, as in assignments.cc.
constexpr double kSamePlace = 0.05;     // relative to the layout's size: a circle farther away is another one
constexpr double kSameDiameter = 0.15;  // in ln(diameter): 4 standard deviations (2.5 %, and 0.25 px for 8 px)

bool are_alike(const Circle& a, const Circle& b) {
  return !(a.diameter_mm > 0.0) || !(b.diameter_mm > 0.0) ||
         std::abs(std::log(a.diameter_mm / b.diameter_mm)) < kSameDiameter;
}

struct ReferenceLayout {
  std::vector<Circle> circles;  // mm, relative to the middle of their bounding box
  double size_mm = 0.0;
};

ReferenceLayout layout_of(const Site& site) {
  ReferenceLayout layout;
  double low_x = 1e300, low_y = 1e300, high_x = -1e300, high_y = -1e300;
  for (const Marker& marker : site.markers) {
    if (marker.role != Role::kReference || !marker.circle) continue;
    layout.circles.push_back(*marker.circle);
    const BoardPoint at = marker.circle->centre;
    low_x = std::min(low_x, at.x), high_x = std::max(high_x, at.x);
    low_y = std::min(low_y, at.y), high_y = std::max(high_y, at.y);
  }
  for (Circle& circle : layout.circles)
    circle.centre = {circle.centre.x - 0.5 * (low_x + high_x), circle.centre.y - 0.5 * (low_y + high_y)};
  if (!layout.circles.empty()) layout.size_mm = std::hypot(high_x - low_x, high_y - low_y);
  return layout;
}

bool maps_onto_itself(const ReferenceLayout& layout, double sign_x, double sign_y) {
  return std::all_of(layout.circles.begin(), layout.circles.end(), [&](const Circle& a) {
    return std::any_of(layout.circles.begin(), layout.circles.end(), [&](const Circle& b) {
      const double off = std::hypot(sign_x * a.centre.x - b.centre.x, sign_y * a.centre.y - b.centre.y);
      return off < kSamePlace * layout.size_mm && are_alike(a, b);
    });
  });
}

}  // namespace

std::optional<std::string> symmetry_note(const Site& site) {
  const ReferenceLayout layout = layout_of(site);
  if (layout.circles.size() < 2) return std::nullopt;
  std::vector<std::string> hidden;
  const auto add = [&](double sign_x, double sign_y, const char* word) {
    if (maps_onto_itself(layout, sign_x, sign_y)) hidden.emplace_back(word);
  };
  add(-1.0, 1.0, "mirrored");
  add(1.0, -1.0, "upside-down");
  add(-1.0, -1.0, "half-rotated");
  if (hidden.empty()) return std::nullopt;
  std::string words = hidden.back();
  if (hidden.size() > 1) {
    hidden.pop_back();
    words = fmt::format("{} or {}", fmt::join(hidden, ", "), words);
  }
  return fmt::format(
      "note: {} {} image cannot be recognised, because the reference circles look the same in it. Make one of them "
      "1.25 times larger",
      words.front() == 'u' ? "an" : "a", words);
}

}  // namespace moiregauge::internal
