// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/reference/scale_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace moiregauge::internal {
namespace {

// Share of the longest distance. The side of a square is 0.71 of its diagonal, and easier to measure. Chosen.
constexpr double kNearlyLongest = 0.7;

BoardPoint centre_of_marker(const Marker& marker) {
  return marker.circle ? marker.circle->centre : marker.grating->centre;
}

std::vector<std::size_t> markers_to_measure(const Site& site) {
  std::vector<std::size_t> references, all;
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    all.push_back(i);
    if (site.markers[i].role == Role::kReference) references.push_back(i);
  }
  return references.size() >= 2 ? references : all;
}

}  // namespace

ScaleCheck scale_check(const Reference& reference) {
  const Site& site = reference.site;
  const std::vector<std::size_t> markers = markers_to_measure(site);
  const auto distance = [&](std::size_t i, std::size_t k) {
    return length(centre_of_marker(site.markers[i]) - centre_of_marker(site.markers[k]));
  };
  BoardPoint middle;
  double longest = 0.0;
  for (const std::size_t i : markers) {
    middle = middle + (1.0 / static_cast<double>(markers.size())) * (centre_of_marker(site.markers[i]) - BoardPoint{});
    for (const std::size_t k : markers) longest = std::max(longest, distance(i, k));
  }
  ScaleCheck check{reference.view.mm_per_px(middle), markers.front(), markers.front(), 0.0};
  for (std::size_t i = 0; i < markers.size(); ++i) {
    for (std::size_t k = i + 1; k < markers.size() && check.from == check.to; ++k) {
      if (distance(markers[i], markers[k]) < kNearlyLongest * longest) continue;
      check.from = markers[i];
      check.to = markers[k];
    }
  }
  const Marker& first = site.markers[check.from];
  const double width = first.grating ? first.grating->width_mm : first.circle->diameter_mm;
  check.distance_mm = check.from == check.to ? width : distance(check.from, check.to);
  return check;
}

std::string short_length(double length, const char* unit) {
  const int digits = length >= 99.95 ? 0 : length >= 9.995 ? 1 : length >= 0.9995 ? 2 : 3;
  char text[60];
  std::snprintf(text, sizeof text, "%.*f %s", digits, length, unit);
  return text;
}

std::string tape_text(const ScaleCheck& check, const Site& site, double unit_mm, const char* unit) {
  const std::string& from = site.markers[check.from].name;
  const std::string size = short_length(check.distance_mm / unit_mm, unit);
  if (check.from == check.to) return "grating of " + from + " = " + size + " wide";
  return from + " to " + site.markers[check.to].name + " = " + size;
}

}  // namespace moiregauge::internal
