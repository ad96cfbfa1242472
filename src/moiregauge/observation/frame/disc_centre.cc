// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/frame/disc_centre.h"

#include <cmath>
#include <cstdint>

#include "moiregauge/observation/raster/pixel_sums.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// All limits are chosen.
constexpr double kPaper = 1.25;  // radii: a disc is surrounded by paper to here
constexpr double kInside = 0.7;  // radii: blur does not reach inside
constexpr int kMaxLooks = 4;
// The first look only starts the next one, so it reads every third row.
constexpr int kFirstRows = 3;
constexpr double kLarge = 40.0;  // px: smallest diameter of which every second row may suffice
// px: largest last movement of the centroid.
constexpr double kConverged_px = 0.1;
constexpr double kSameArea = 0.05;    // relative
constexpr double kMinContrast = 0.4;  // relative to the earlier contrast

struct DiscLook {
  ImagePoint centre;
  double area = 0.0;      // pixels with the contrast of the disc's middle
  double contrast = 0.0;  // grey levels, middle minus paper
};

std::optional<DiscLook> look_at_disc(const LumaView& luma, ImagePoint at, double radius, int row_step) {
  const double reach = kPaper * radius;
  const int x0 = static_cast<int>(std::floor(at.x - reach)), x1 = static_cast<int>(std::ceil(at.x + reach));
  const int y0 = static_cast<int>(std::floor(at.y - reach)), y1 = static_cast<int>(std::ceil(at.y + reach));
  if (!(x0 >= 0 && y0 >= 0 && x1 < width_of(luma) && y1 < height_of(luma))) return std::nullopt;
  // The window, the window without certain paper, and certain disc.
  const DiscSums sums = sum_disc(luma, at, {reach, 0.5 * (1.0 + kPaper) * radius, kInside * radius}, row_step);
  const std::int64_t papers = sums.pixels - sums.ring_pixels;
  if (sums.middle_pixels == 0 || papers == 0) return std::nullopt;
  const double paper = static_cast<double>(sums.grey - sums.ring_grey) / static_cast<double>(papers);
  DiscLook out;
  out.contrast = static_cast<double>(sums.middle_grey) / static_cast<double>(sums.middle_pixels) - paper;
  if (out.contrast == 0.0) return std::nullopt;
  // Moments of (g - paper) / contrast, which is 1 on the disc and 0 on its paper.
  const auto above_paper = [paper](std::int64_t grey, std::int64_t of) {
    return static_cast<double>(grey) - paper * static_cast<double>(of);
  };
  out.area = above_paper(sums.grey, sums.pixels) / out.contrast;  // in the rows that were read
  if (!(out.area > 0.0)) return std::nullopt;
  const double weight = 1.0 / (out.contrast * out.area);
  out.centre = {sums.x0 + weight * above_paper(sums.grey_x, sums.x),
                sums.y0 + weight * above_paper(sums.grey_y, sums.y)};
  return out;
}

}  // namespace

std::optional<ImagePoint> disc_centre(const LumaView& luma, ImagePoint expected, double diameter_px,
                                      const DetectedCircle& like, Rows rows) {
  const double radius = 0.5 * diameter_px;
  ImagePoint at = expected;
  for (int k = 0; k < kMaxLooks; ++k) {
    const int row_step = k == 0 ? kFirstRows : rows == Rows::kAll || diameter_px < kLarge ? 1 : 2;
    const auto seen = look_at_disc(luma, at, radius, row_step);
    if (!seen || !(seen->contrast * like.contrast > 0.0) || !(length(seen->centre - at) < radius)) return std::nullopt;
    const double moved = length(seen->centre - at);
    at = seen->centre;
    if (k == 0 || moved > kConverged_px) continue;
    const bool same = std::abs(row_step * seen->area / (kPi * radius * radius) - 1.0) < kSameArea &&
                      std::abs(seen->contrast) > kMinContrast * std::abs(like.contrast);
    return same ? std::optional(at) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace moiregauge::internal
