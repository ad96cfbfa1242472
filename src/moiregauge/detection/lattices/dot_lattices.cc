// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "moiregauge/detection/circles/circle_verdict.h"
#include "moiregauge/detection/lattices/indexed_lattice.h"
#include "moiregauge/detection/lattices/indexing.h"
#include "moiregauge/detection/lattices/lattice_growth.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using markers_detail::CellPrediction;
using markers_detail::Ellipse;
using markers_detail::GrownLattice;
using markers_detail::LatticeNode;

// Limits for a dot at a predicted position. Position, size and contrast are known, so the limits of the shape are
// wider.
constexpr double kDotReach = 0.12;            // relative to the spacing, distance from the prediction
constexpr double kSizeSlack = 1.35;           // ratio to the predicted diameter
constexpr double kMinDotContrastShare = 0.4;  // relative to the neighbour's contrast
constexpr double kMinDotCircularity = 0.78;   // W
constexpr double kEllipseSlack = 1.6;         // times the usual limit; a square differs by more than two limits

LatticeNode node_of(const DetectedCircle& circle) {
  return {{circle.centre.x, circle.centre.y}, circle.diameter_px, circle.contrast < 0.0 ? 0.0 : kPi};
}

Ellipse ellipse_at(const Eigen::Vector2d& centre, const DetectedCircle& like, double diameter_px) {
  const double minor = 0.5 * diameter_px * std::sqrt(like.axis_ratio), major = minor / like.axis_ratio;
  const Eigen::Vector2d along(std::cos(like.angle_rad), std::sin(like.angle_rad)), across(-along.y(), along.x());
  return {centre, major * along * along.transpose() + minor * across * across.transpose()};
}

// Searches a dot at a predicted position. Adds it to `dots`, whose order is that of the nodes.
std::optional<LatticeNode> dot_again(const LumaView& luma, const CellPrediction& there,
                                     std::vector<DetectedCircle>& dots) {
  const DetectedCircle& neighbour = dots[there.nearest];
  CircleOptions options;
  options.min_circularity = kMinDotCircularity;
  options.min_diameter_px = there.size_px / kSizeSlack;
  options.max_diameter_px = there.size_px * kSizeSlack;
  const auto verdict =
      markers_detail::judge_circle(luma, ellipse_at(there.at, neighbour, there.size_px), options, kEllipseSlack);
  if (!verdict.circle) return std::nullopt;
  const DetectedCircle& dot = *verdict.circle;
  const LatticeNode node = node_of(dot);
  if (dot.diameter_px < options.min_diameter_px || dot.diameter_px > options.max_diameter_px) return std::nullopt;
  if ((node.at - there.at).norm() > kDotReach * there.spacing_px) return std::nullopt;
  if (dot.contrast / neighbour.contrast < kMinDotContrastShare) return std::nullopt;
  dots.push_back(dot);
  return node;
}

std::vector<IndexedLattice> lattices_of(const LumaView* luma, std::span<const DetectedCircle> circles) {
  std::vector<DetectedCircle> dots(circles.begin(), circles.end());
  std::vector<LatticeNode> nodes;
  nodes.reserve(dots.size());
  for (const DetectedCircle& dot : dots) nodes.push_back(node_of(dot));
  std::vector<IndexedLattice> out;
  for (GrownLattice& lattice : grow_lattices(nodes, markers_detail::SignRule::kAlike)) {
    if (luma != nullptr) {
      fill_in(lattice, nodes, [&](const CellPrediction& there) { return dot_again(*luma, there, dots); });
      if (!prune(lattice, nodes)) continue;
    }
    std::vector<double> u;
    u.reserve(dots.size());
    for (const DetectedCircle& dot : dots) u.push_back(dot.u_centre_px);
    auto indexing = index_upright(lattice, nodes, u);
    indexing.lattice.dark = dots[indexing.node.front()].contrast < 0.0;
    out.push_back(std::move(indexing.lattice));
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const auto& a, const auto& b) { return a.points.size() > b.points.size(); });
  return out;
}

}  // namespace

std::vector<IndexedLattice> find_dot_lattices(std::span<const DetectedCircle> circles) {
  return lattices_of(nullptr, circles);
}

std::vector<IndexedLattice> find_dot_lattices(const LumaView& luma, std::span<const DetectedCircle> seen) {
  return lattices_of(&luma, seen);
}

std::vector<IndexedLattice> find_dot_lattices(const LumaView& luma, const DotSearchOptions& options) {
  CircleOptions circles;
  circles.min_diameter_px = options.min_diameter_px;
  circles.max_diameter_px = options.max_diameter_px;
  return lattices_of(&luma, find_circles(luma, circles).circles);
}

}  // namespace moiregauge::internal
