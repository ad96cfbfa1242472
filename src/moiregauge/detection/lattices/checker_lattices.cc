// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

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

constexpr double kMinExplained = 0.85;           // of the grey levels' variance in the window
constexpr double kMinSymmetric = 0.85;           // 0.98 and more of corners, 0.8 and less of what lies round a pattern
constexpr double kMinWeakest = 0.5;              // of the contrast
constexpr double kMaxUncertainty = 0.05;         // of the spacing
constexpr double kMinCornerContrastShare = 0.3;  // of its neighbour's
constexpr std::size_t kTooManyFailed = 20;       // and half of those tried
constexpr double kCornerReach = 0.15;            // of the spacing
// A board has a few thousand corners. A picture of more is texture, and looking for lattices in it takes a minute.
constexpr std::size_t kMaxCandidates = 20000;

// Is it light between one column on and one row on?
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
  const auto saddle = markers_detail::fit_saddle(luma, {at, there.step, light_between(there.step, there.sign_rad)});
  if (!saddle || saddle->explained < kMinExplained) return std::nullopt;
  if (saddle->symmetric < kMinSymmetric || saddle->weakest < kMinWeakest) return std::nullopt;
  if (saddle->contrast < kMinCornerContrastShare * neighbour_contrast) return std::nullopt;
  if (saddle->u_px > kMaxUncertainty * there.spacing_px) return std::nullopt;
  return saddle;
}

double side_of(const CellPrediction& there) { return std::sqrt(std::abs(there.step.determinant())); }

// To sub-pixel places, each from the scale of its own surroundings; what fits no corner is taken out. False
// when that is most of it: saddles lie between dots, too.
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
