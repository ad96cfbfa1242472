// SPDX-License-Identifier: Apache-2.0
// Gives the points of a grown lattice columns (rightwards) and rows (downwards) from (0, 0).
#pragma once

#include <span>
#include <vector>

#include "moiregauge/detection/lattices/indexed_lattice.h"
#include "moiregauge/detection/lattices/lattice_growth.h"

namespace moiregauge::internal::markers_detail {

struct Indexing {
  IndexedLattice lattice;                           // the caller sets `dark`
  std::vector<std::size_t> node;                    // per point of the lattice: index into the nodes
  Eigen::Matrix2d steps = Eigen::Matrix2d::Zero();  // px; columns: mean step of one column, of one row
};

// Selects upright axes and returns the indexed lattice. A grown lattice has the axes of its seed, in any rotation.
// `u_px` is the standard uncertainty of each node.
[[nodiscard]] Indexing index_upright(const GrownLattice& lattice, std::span<const LatticeNode> nodes,
                                     std::span<const double> u_px);

}  // namespace moiregauge::internal::markers_detail
