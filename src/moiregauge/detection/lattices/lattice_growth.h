// SPDX-License-Identifier: Apache-2.0
// Lattices among points: seeds of 3 x 3, growth by local prediction, and no point kept that its neighbours contradict.
// Nothing here assumes a straight line to stay straight: only that the lattice bends little from one step to the next.
#pragma once

#include <compare>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Dense>

namespace moiregauge::internal::markers_detail {

struct LatticeNode {
  Eigen::Vector2d at{0, 0};  // px
  double size_px = 0.0;      // 0: has none
  double sign_rad = 0.0;     // dots: 0 dark, pi light; corners: the phase of light and dark round the point
};

// How the sign changes from one neighbour to the next.
enum class SignRule { kAlike, kAlternating };

struct Cell {
  int column = 0;
  int row = 0;
  friend auto operator<=>(const Cell&, const Cell&) = default;
};

struct GrownLattice {
  SignRule rule = SignRule::kAlike;
  std::map<Cell, std::size_t> node_at;
};

// What the points round a cell, itself left out, say of it.
struct CellPrediction {
  Eigen::Vector2d at{0, 0};
  Eigen::Matrix2d step = Eigen::Matrix2d::Zero();  // px; columns: one column on, one row on
  double spacing_px = 0.0;                         // the shorter of the two
  double size_px = 0.0;                            // median of the neighbours'
  double sign_rad = 0.0;
  std::size_t nearest = 0;  // node of the nearest known cell
  int neighbours = 0;       // known ones of the eight round it
};

inline constexpr std::size_t kMinLatticePoints = 9;  // of a lattice

// Are two sizes (px) within this ratio of each other? One that is not known (0) is like any other.
[[nodiscard]] inline bool alike_sizes(double size, double other, double ratio) {
  if (size <= 0.0 || other <= 0.0) return true;
  return size < ratio * other && other < ratio * size;
}

enum class LocalModel { kAffine, kQuadratic };  // the latter where there are points enough, else affine

// Cells on each side of the one that is predicted.
inline constexpr int kAffineReach = 2;
inline constexpr int kQuadraticReach = 3;

[[nodiscard]] std::optional<CellPrediction> predict(const GrownLattice& lattice, std::span<const LatticeNode> nodes,
                                                    Cell cell, LocalModel model);

// All lattices of at least 3 x 3 points, largest first; a node belongs to one of them at most.
[[nodiscard]] std::vector<GrownLattice> grow_lattices(std::span<const LatticeNode> nodes, SignRule rule);

// Looks at every empty cell with three neighbours or more until nothing is added. `look` returns the point it sees
// there.
using Look = std::function<std::optional<LatticeNode>(const CellPrediction&)>;
void fill_in(GrownLattice& lattice, std::vector<LatticeNode>& nodes, const Look& look);

// Takes out what the neighbours contradict and what hangs on by a thread. False when no lattice is left.
[[nodiscard]] bool prune(GrownLattice& lattice, std::span<const LatticeNode> nodes);

}  // namespace moiregauge::internal::markers_detail
