// SPDX-License-Identifier: Apache-2.0
// Input: any grey levels as an image. The first byte is the width minus 16. Bit 0 of the second byte selects 10 bits in
// 16-bit words. The pixels follow, row by row. Requires: detection of circles, gratings and lattices, and
// identification on the small rig's site, give finite values.
#include <algorithm>
#include <cmath>
#include <vector>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/detection/gratings/grating_patches.h"
#include "moiregauge/detection/identity/identify_markers.h"
#include "moiregauge/detection/lattices/indexed_lattice.h"
#include "tests/fuzz/input_file.h"

namespace moiregauge::internal {
namespace {

Site four_circles() {
  Site site;
  for (const double y : {40.0, -40.0}) {
    for (const double x : {-128.0, 128.0}) {
      Marker marker;
      marker.name = std::to_string(site.markers.size());
      marker.circle = Circle{{x, y}, 16.0};
      site.markers.push_back(marker);
    }
  }
  return site;
}

template <typename Grey>
Image<Grey> picture_of(fuzz::Bytes pixels, int width, int shift) {
  Image<Grey> picture(width, static_cast<int>(pixels.size()) / width);
  for (int y = 0; y < picture.height(); ++y) {
    const auto from = pixels.subspan(static_cast<std::size_t>(y * width), static_cast<std::size_t>(width));
    std::transform(from.begin(), from.end(), picture.row(y).begin(),
                   [&](std::uint8_t grey) { return static_cast<Grey>(grey << shift); });
  }
  return picture;
}

void look_at(const LumaView& luma, int bits) {
  const CircleSearch search = find_circles(luma, {});
  for (const DetectedCircle& circle : search.circles) {
    fuzz::demand(std::isfinite(circle.centre.x) && std::isfinite(circle.centre.y) && circle.u_centre_px >= 0.0);
    static_cast<void>(find_circles_near(luma, circle.centre, circle.diameter_px, 4.0, {}));
  }
  for (const DetectedPatch& patch : find_grating_patches(luma, {.bits = bits}))
    fuzz::demand(std::isfinite(patch.centre.x) && std::isfinite(patch.centre.y));
  static_cast<void>(find_checker_lattices(luma, bits));
  static_cast<void>(find_dot_lattices(luma, search.circles));
  static const Site site = four_circles();
  if (const auto who = identify_first(site, search)) fuzz::demand(who->circle_of_marker.size() == site.markers.size());
}

}  // namespace
}  // namespace moiregauge::internal

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moiregauge::internal;
  if (size < 2) return 0;
  const int width = 16 + data[0];
  const fuzz::Bytes pixels(data + 2, size - 2);
  if (pixels.size() < static_cast<std::size_t>(width)) return 0;
  if (data[1] % 2 == 0) {
    const auto picture = picture_of<std::uint8_t>(pixels, width, 0);
    look_at(picture.view(), 8);
  } else {
    const auto picture = picture_of<std::uint16_t>(pixels, width, 2);
    look_at(picture.view(), 10);
  }
  return 0;
}
