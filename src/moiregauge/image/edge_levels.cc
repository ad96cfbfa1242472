// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/image/edge_levels.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace moiregauge::internal {
namespace {

// Distances from the centre in radii, chosen: the disc's inside, the paper around it, and the edge's reach. A disc tilted
// by 30 degrees has 0.87 of its diameter, so that its edge stays outside the first and inside the last.
constexpr double kInside = 0.7;
constexpr double kPaperFrom = 1.15, kPaperTo = 1.3;
constexpr double kReach = 1.25;
constexpr std::size_t kMinPixels = 20;      // for the medians of disc and paper
constexpr double kMinContrast_grey = 10.0;  // below it noise fills the range between both levels

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Calls visit(grey level, distance from the centre in radii) for the pixels within `reach` radii.
template <typename Picture, typename Visit>
void for_pixels_round(const Picture& picture, double x, double y, double radius, Visit visit) {
  const int reach = static_cast<int>(std::ceil(kPaperTo * radius));
  const int left = static_cast<int>(std::lround(x)) - reach, top = static_cast<int>(std::lround(y)) - reach;
  for (int v = top; v <= top + 2 * reach; ++v) {
    for (int u = left; u <= left + 2 * reach; ++u)
      visit(static_cast<double>(picture.at(u, v)), std::hypot(u - x, v - y) / radius);
  }
}

}  // namespace

void EdgeLevels::add_disc(const LumaView& luma, double centre_x, double centre_y, double diameter_px) {
  const double radius = 0.5 * diameter_px, half = kPaperTo * radius + 2.0;
  std::visit(
      [&](const auto& picture) {
        if (!(radius > 0.0) || centre_x < half || centre_y < half || centre_x + half > picture.width ||
            centre_y + half > picture.height)
          return;
        std::vector<double> disc, paper;
        for_pixels_round(picture, centre_x, centre_y, radius, [&](double grey, double r) {
          if (r < kInside) disc.push_back(grey);
          if (r > kPaperFrom && r < kPaperTo) paper.push_back(grey);
        });
        if (disc.size() < kMinPixels || paper.size() < kMinPixels) return;
        const double dark = median(disc), light = median(paper);
        if (std::abs(light - dark) < kMinContrast_grey) return;
        rim_px_ += M_PI * diameter_px;
        constexpr double kBin = (kHighestEdgeLevel - kLowestEdgeLevel) / kEdgeBins;
        for_pixels_round(picture, centre_x, centre_y, radius, [&](double grey, double r) {
          const double bin = std::floor(((grey - dark) / (light - dark) - kLowestEdgeLevel) / kBin);
          if (r < kReach && bin >= 0.0 && bin < kEdgeBins) ++bins_[static_cast<std::size_t>(bin)];
        });
      },
      luma);
}

long EdgeLevels::all() const {
  const double least = (kHighestEdgeLevel - kLowestEdgeLevel) * rim_px_;
  return std::max(std::accumulate(bins_.begin(), bins_.end(), 0L), std::lround(least));
}

long EdgeLevels::in_emptiest_range() const {
  long fewest = all();
  for (auto first = bins_.begin(); first + kEdgeBinsGap <= bins_.end(); ++first)
    fewest = std::min(fewest, std::accumulate(first, first + kEdgeBinsGap, 0L));
  return fewest;
}

}  // namespace moiregauge::internal
