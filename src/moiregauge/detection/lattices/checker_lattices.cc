// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "moiregauge/detection/lattices/checker_corners.h"
#include "moiregauge/detection/lattices/indexed_lattice.h"
#include "moiregauge/detection/lattices/indexing.h"
#include "moiregauge/detection/lattices/lattice_growth.h"
#include "moiregauge/detection/lattices/saddle_fit.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using markers_detail::Cell;
using markers_detail::CellPrediction;
using markers_detail::FittedSaddle;
using markers_detail::GrownLattice;
using markers_detail::LatticeNode;
using markers_detail::LocalModel;

constexpr double kMinExplained = 0.85;           // share of the variance in the window (chosen)
constexpr double kMinSymmetric = 0.85;           // correlation: corners have 0.98 or more, other points 0.8 or less
constexpr double kMinWeakest = 0.5;              // relative to the contrast (chosen)
constexpr double kMaxUncertainty = 0.05;         // relative to the spacing (chosen)
constexpr double kMinCornerContrastShare = 0.3;  // relative to the neighbour's contrast (chosen)
constexpr std::size_t kTooManyFailed = 20;       // fits; the refinement stops if half of the fits failed, too
constexpr double kCornerReach = 0.15;            // relative to the spacing, distance from the prediction
// A board has a few thousand corners. More candidates are texture, in which a search for lattices takes a minute.
constexpr std::size_t kMaxCandidates = 20000;

// Returns true if the quadrant between the step of one column and the step of one row is light.
bool light_between(const Eigen::Matrix2d& step, double light_rad) {
  const Eigen::Vector2d between = step.col(0).normalized() + step.col(1).normalized();
  return std::cos(2.0 * std::atan2(between.y(), between.x()) - light_rad) > 0.0;
}

struct Corners {
  std::vector<LatticeNode> nodes;
  std::vector<double> u_px, contrast;
};

Corners corner_candidates(const LumaView& luma, int bits) {
  Corners out;
  for (const auto& corner : markers_detail::find_checker_corners(luma, bits)) {
    out.nodes.push_back({corner.at, 0.0, corner.light_rad});
    out.u_px.push_back(0.0);
    out.contrast.push_back(corner.contrast);
  }
  return out;
}

std::optional<FittedSaddle> corner_at(const LumaView& luma, const Eigen::Vector2d& at, const CellPrediction& there,
                                      double neighbour_contrast) {
  auto saddle = markers_detail::fit_saddle(luma, {at, there.step, light_between(there.step, there.sign_rad)});
  if (!saddle || saddle->explained < kMinExplained) return std::nullopt;
  if (saddle->symmetric < kMinSymmetric || saddle->weakest < kMinWeakest) return std::nullopt;
  if (saddle->contrast < kMinCornerContrastShare * neighbour_contrast) return std::nullopt;
  if (saddle->u_px > kMaxUncertainty * there.spacing_px) return std::nullopt;
  return saddle;
}

double side_of(const CellPrediction& there) { return std::sqrt(std::abs(there.step.determinant())); }

// Moves the corners to sub-pixel positions, with windows by the local spacing, and removes those that fit no corner.
// Returns false if half of them or more fail, as for the saddles between dots.
bool refine(const LumaView& luma, GrownLattice& lattice, Corners& corners) {
  std::vector<std::pair<Cell, std::optional<FittedSaddle>>> fits;
  std::size_t failed = 0;
  for (const auto& [cell, node] : lattice.node_at) {
    const auto there = predict(lattice, corners.nodes, cell, LocalModel::kAffine);
    const auto saddle =
        there ? corner_at(luma, corners.nodes[node].at, *there, corners.contrast[there->nearest]) : std::nullopt;
    if (saddle) corners.nodes[node].size_px = side_of(*there);
    failed += saddle ? 0 : 1;
    if (failed > kTooManyFailed && 2 * failed > fits.size()) return false;
    fits.emplace_back(cell, saddle);
  }
  for (const auto& [cell, saddle] : fits) {
    if (!saddle) {
      lattice.node_at.erase(cell);
      continue;
    }
    const std::size_t node = lattice.node_at.at(cell);
    corners.nodes[node].at = saddle->at;
    corners.u_px[node] = saddle->u_px;
    corners.contrast[node] = saddle->contrast;
  }
  return 2 * lattice.node_at.size() > fits.size();
}

std::optional<LatticeNode> corner_again(const LumaView& luma, const CellPrediction& there, Corners& corners) {
  const auto saddle = corner_at(luma, there.at, there, corners.contrast[there.nearest]);
  if (!saddle || (saddle->at - there.at).norm() > kCornerReach * there.spacing_px) return std::nullopt;
  corners.u_px.push_back(saddle->u_px);
  corners.contrast.push_back(saddle->contrast);
  return LatticeNode{saddle->at, side_of(there), there.sign_rad};
}

}  // namespace

std::vector<IndexedLattice> find_checker_lattices(const LumaView& luma, int bits) {
  std::vector<IndexedLattice> out;
  Corners corners = corner_candidates(luma, bits);
  if (corners.nodes.size() > kMaxCandidates) return out;
  for (GrownLattice& lattice : grow_lattices(corners.nodes, markers_detail::SignRule::kAlternating)) {
    if (!refine(luma, lattice, corners)) continue;
    fill_in(lattice, corners.nodes, [&](const CellPrediction& there) { return corner_again(luma, there, corners); });
    if (!prune(lattice, corners.nodes)) continue;
    auto indexing = index_upright(lattice, corners.nodes, corners.u_px);
    const LatticePoint& first = indexing.lattice.points.front();
    const bool light = light_between(indexing.steps, corners.nodes[indexing.node.front()].sign_rad);
    indexing.lattice.dark = light == ((first.column + first.row) % 2 != 0);
    out.push_back(std::move(indexing.lattice));
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const auto& a, const auto& b) { return a.points.size() > b.points.size(); });
  return out;
}

}  // namespace moiregauge::internal
