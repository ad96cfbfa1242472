// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/disc_centre.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "moiregauge/units/units.h"

namespace moiregauge {
namespace {

constexpr double kPaper = 1.25;    // radii: so far there is paper round a disc
constexpr double kInside = 0.7;    // radii: no blur reaches in here
constexpr int kMostLooks = 4;
constexpr double kStands = 0.1;    // px: the centroid of a window round it that moves no further
constexpr double kSameArea = 0.05;  // relative
constexpr double kLeastContrast = 0.4;  // of the contrast that it had

struct Look {
  ImagePoint centre;
  double area = 0.0;      // pixels, as dark as the disc's middle
  double contrast = 0.0;  // grey levels, middle less paper
};

template <typename Grey>
std::optional<Look> look(const ImageView<Grey>& picture, ImagePoint at, double radius) {
  const double reach = kPaper * radius;
  const int x0 = static_cast<int>(std::floor(at.x - reach)), x1 = static_cast<int>(std::ceil(at.x + reach));
  const int y0 = static_cast<int>(std::floor(at.y - reach)), y1 = static_cast<int>(std::ceil(at.y + reach));
  if (!(x0 >= 0 && y0 >= 0 && x1 < picture.width && y1 < picture.height)) return std::nullopt;
  double middle = 0.0, paper = 0.0, grey = 0.0, grey_x = 0.0, grey_y = 0.0, sum_x = 0.0, sum_y = 0.0;
  long middles = 0, papers = 0, all = 0;
  const double inner2 = std::pow(kInside * radius, 2), ring2 = std::pow(0.5 * (1.0 + kPaper) * radius, 2);
  for (int y = y0; y <= y1; ++y) {
    const double dy = y - at.y, half2 = reach * reach - dy * dy;
    if (half2 < 0.0) continue;
    const double half = std::sqrt(half2);
    const auto row = picture.row(y);
    for (int x = static_cast<int>(std::ceil(at.x - half)); x <= at.x + half; ++x) {
      const double dx = x - at.x, r2 = dx * dx + dy * dy, g = static_cast<double>(row[static_cast<std::size_t>(x)]);
      grey += g, grey_x += g * dx, grey_y += g * dy, sum_x += dx, sum_y += dy, ++all;
      if (r2 < inner2)
        middle += g, ++middles;
      else if (r2 > ring2)
        paper += g, ++papers;
    }
  }
  if (middles == 0 || papers == 0) return std::nullopt;
  middle /= static_cast<double>(middles), paper /= static_cast<double>(papers);
  Look out;
  out.contrast = middle - paper;
  if (out.contrast == 0.0) return std::nullopt;
  // Moments of (g - paper) / contrast, which is one on the disc and nothing on its paper.
  out.area = (grey - paper * static_cast<double>(all)) / out.contrast;
  if (!(out.area > 0.0)) return std::nullopt;
  const double weight = 1.0 / (out.contrast * out.area);
  out.centre = {at.x + weight * (grey_x - paper * sum_x), at.y + weight * (grey_y - paper * sum_y)};
  return out;
}

}  // namespace

std::optional<ImagePoint> disc_centre(const LumaView& luma, ImagePoint expected, double diameter_px,
                                      const SeenCircle& like) {
  const double radius = 0.5 * diameter_px;
  ImagePoint at = expected;
  for (int k = 0; k < kMostLooks; ++k) {
    const auto seen = std::visit([&](const auto& picture) { return look(picture, at, radius); }, luma);
    if (!seen || !(seen->contrast * like.contrast > 0.0) || !(length(seen->centre - at) < radius)) return std::nullopt;
    const double moved = length(seen->centre - at);
    at = seen->centre;
    if (moved > kStands) continue;
    const bool same = std::abs(seen->area / (kPi * radius * radius) - 1.0) < kSameArea &&
                      std::abs(seen->contrast) > kLeastContrast * std::abs(like.contrast);
    return same ? std::optional(at) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace moiregauge
