// SPDX-License-Identifier: Apache-2.0
// Finds lattices among points: seeds of 3 x 3 points, growth by local prediction, removal of points that do not fit
// their neighbours. Straight lines may be bent by the lens. Only the change from one step to the next must be small.
#pragma once

#include <compare>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace moiregauge::internal::markers_detail {

struct LatticeNode {
  Eigen::Vector2d at{0, 0};  // px
  double size_px = 0.0;      // px; 0: unknown
  double sign_rad = 0.0;     // rad; dots: 0 dark, pi light; corners: twice the direction of the light sectors
};

// Change of the sign between neighbours: none for dots, alternating for corners.
enum class SignRule { kAlike, kAlternating };

struct Cell {
  int column = 0;
  int row = 0;
  friend auto operator<=>(const Cell&, const Cell&) = default;  // NOLINT(modernize-use-nullptr): no pointer here
};

struct GrownLattice {
  SignRule rule = SignRule::kAlike;
  std::map<Cell, std::size_t> node_at;  // index of the node in each occupied cell
};

// Prediction for one cell from the points around it, without its own.
struct CellPrediction {
  Eigen::Vector2d at{0, 0};                        // px
  Eigen::Matrix2d step = Eigen::Matrix2d::Zero();  // px; columns: step of one column, of one row
  double spacing_px = 0.0;                         // px, length of the shorter step
  double size_px = 0.0;                            // px, median of the points around
  double sign_rad = 0.0;                           // rad
  std::size_t nearest = 0;                         // node of the nearest occupied cell
  int neighbours = 0;                              // occupied cells among the eight neighbours
};

inline constexpr std::size_t kMinLatticePoints = 9;  // 3 x 3

// Returns true if two sizes (px) are within this ratio of each other, or one of them is unknown (0).
[[nodiscard]] inline bool alike_sizes(double size, double other, double ratio) {
  if (size <= 0.0 || other <= 0.0) return true;
  return size < ratio * other && other < ratio * size;
}

enum class LocalModel { kAffine, kQuadratic };  // kQuadratic becomes affine if there are too few points

// Cells on each side of the predicted one.
inline constexpr int kAffineReach = 2;
inline constexpr int kQuadraticReach = 3;

// Predicts a cell by a weighted local fit. Empty if fewer than three points are near or they are on one line.
[[nodiscard]] std::optional<CellPrediction> predict(const GrownLattice& lattice, std::span<const LatticeNode> nodes,
                                                    Cell cell, LocalModel model);

// Returns all lattices of at least 3 x 3 points, largest first. A node belongs to at most one of them.
[[nodiscard]] std::vector<GrownLattice> grow_lattices(std::span<const LatticeNode> nodes, SignRule rule);

// Returns the point found near a prediction; empty if there is none.
using Look = std::function<std::optional<LatticeNode>(const CellPrediction&)>;
// Calls `look` for all empty cells with at least three neighbours, and adds the points found, until none is added.
void fill_in(GrownLattice& lattice, std::vector<LatticeNode>& nodes, const Look& look);

// Removes points that do not fit their neighbours; points with fewer than three neighbours have stricter limits.
// Returns false if no lattice remains.
[[nodiscard]] bool prune(GrownLattice& lattice, std::span<const LatticeNode> nodes);

}  // namespace moiregauge::internal::markers_detail
