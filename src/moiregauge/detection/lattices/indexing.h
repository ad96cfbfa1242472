// SPDX-License-Identifier: Apache-2.0
// From a grown lattice, whose axes are those of its seed, to columns rightwards and rows downwards from (0, 0).
#pragma once

#include <span>
#include <vector>

#include "moiregauge/detection/lattices/indexed_lattice.h"
#include "moiregauge/detection/lattices/lattice_growth.h"

namespace moiregauge::internal::markers_detail {

struct Indexing {
  IndexedLattice lattice;                           // `dark` is left to the caller
  std::vector<std::size_t> node;                    // of every point
  Eigen::Matrix2d steps = Eigen::Matrix2d::Zero();  // px, mean: one column on, one row on
};

// u_px: of every node.
[[nodiscard]] Indexing index_upright(const GrownLattice& lattice, std::span<const LatticeNode> nodes,
                                     std::span<const double> u_px);

}  // namespace moiregauge::internal::markers_detail
