// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/reference/site_layout.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <Eigen/Eigenvalues>

#include "moiregauge/geometry/symmetric_eigen.h"

namespace moiregauge::internal {
namespace {

// Smallest width of a layout relative to its length. The uncertainty across the layout grows as length / width. At this
// limit a reading of 1 um has a u of 0.1 mm. Chosen.
constexpr double kLine = 0.005;

}  // namespace

std::optional<std::string> references_on_a_line(const Site& site) {
  std::vector<Eigen::Vector2d> at;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Marker& m : site.markers) {
    if (m.role != Role::kReference || !m.circle) continue;
    at.emplace_back(m.circle->centre.x, m.circle->centre.y);
    mean += at.back();
  }
  if (at.size() < 4) return std::nullopt;
  mean /= static_cast<double>(at.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const auto& p : at) spread += (p - mean) * (p - mean).transpose();
  const Eigen::Matrix2d axes = eigen_of(spread).vectors;
  const auto extent = [&](Eigen::Index axis) {
    double low = 0.0, high = 0.0;
    for (const auto& p : at) {
      const double along = axes.col(axis).dot(p - mean);
      low = std::min(low, along), high = std::max(high, along);
    }
    return high - low;
  };
  const double width = extent(0), length = extent(1);
  if (width > kLine * length) return std::nullopt;
  char text[320];
  std::snprintf(text, sizeof text,
                "the site's reference circles are almost on one line, %.0f mm long and %.1f mm wide, so u_dx and u_dy "
                "would have no bound. Move two of them off the line by %.0f mm or more",
                length, width, 0.1 * length);
  return text;
}

}  // namespace moiregauge::internal
