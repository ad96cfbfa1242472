// SPDX-License-Identifier: Apache-2.0
// Input: any circles. The first byte determines the number of references of the site (4 to 8). Each circle has five
// bytes: x and y (two bytes each, 1/16 px) and diameter (px, minus 7). Requires: identification ends and assigns
// different circles to at least four markers, or is refused.
#include "moiregauge/detection/identity/identify_markers.h"

#include <cmath>
#include <set>

#include "tests/fuzz/input_file.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kCircleBytes = 5;

Site ring_of(int references) {
  Site site;
  for (int k = 0; k < references; ++k) {
    Marker marker;
    marker.name = std::to_string(k);
    marker.circle = Circle{{k % 2 == 0 ? -128.0 : 128.0, 40.0 - 80.0 * (k / 2) / ((references - 1) / 2)}, 16.0};
    site.markers.push_back(marker);
  }
  return site;
}

CircleSearch circles_of(fuzz::Bytes bytes) {
  CircleSearch search;
  for (; bytes.size() >= kCircleBytes; bytes = bytes.subspan(kCircleBytes)) {
    DetectedCircle circle;
    circle.centre = {(bytes[0] * 256 + bytes[1]) / 16.0, (bytes[2] * 256 + bytes[3]) / 16.0};
    circle.diameter_px = 7.0 + bytes[4];
    circle.circularity = 0.9;
    circle.u_centre_px = 0.01;
    circle.contrast = 100.0;
    search.circles.push_back(circle);
  }
  return search;
}

}  // namespace
}  // namespace moiregauge::internal

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moiregauge::internal;
  if (size == 0) return 0;
  const Site site = ring_of(4 + data[0] % 5);
  const CircleSearch search = circles_of({data + 1, size - 1});
  const auto who = identify_first(site, search);
  if (!who) return 0;
  std::set<int> taken;
  std::size_t seen = 0;
  for (const int circle : who->circle_of_marker) {
    fuzz::demand(circle >= -1 && circle < static_cast<int>(search.circles.size()));
    if (circle >= 0) taken.insert(circle);
    seen += circle >= 0 ? 1 : 0;
  }
  fuzz::demand(seen >= 4 && taken.size() == seen);  // no circle is two markers
  static_cast<void>(identify_next(site, search, {who->image_from_board, 0.0}));
  return 0;
}
