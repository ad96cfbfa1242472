// SPDX-License-Identifier: Apache-2.0
// Empty cells around a growing lattice, with a flag for those whose prediction has changed. A repeated search of all
// empty cells would take time proportional to the number of points to the power of 1.5.
#pragma once

#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>
#include <vector>

#include "moiregauge/detection/lattices/lattice_growth.h"

namespace moiregauge::internal::markers_detail {

class LatticeFrontier {
 public:
  // Starts with the empty cells around `lattice`. `reach` is the number of cells over which a point changes
  // predictions.
  LatticeFrontier(const GrownLattice& lattice, int reach) : reach_(reach) {
    for (const auto& [cell, node] : lattice.node_at) add(lattice, cell);
  }

  // Returns the empty cells with at least `support` occupied cells among their eight neighbours, in order.
  [[nodiscard]] std::vector<Cell> cells(int support) const {
    std::vector<Cell> found;
    for (const auto& [cell, state] : empty_) {
      if (state.known >= support) found.push_back(cell);
    }
    return found;
  }

  // Returns true if a point was added within reach of this empty cell since the last call. Otherwise a new search would
  // give the same result.
  [[nodiscard]] bool take_change(Cell cell) {
    const auto found = empty_.find(cell);
    return found != empty_.end() && std::exchange(found->second.has_changed, false);
  }

  // Updates the frontier; call it after adding the cell to the lattice.
  void add(const GrownLattice& lattice, Cell added) {
    empty_.erase(added);
    for (int dr = -reach_; dr <= reach_; ++dr) {
      for (int dc = -reach_; dc <= reach_; ++dc) {
        const Cell other{added.column + dc, added.row + dr};
        if (std::abs(dr) > 1 || std::abs(dc) > 1) {
          if (const auto found = empty_.find(other); found != empty_.end()) found->second.has_changed = true;
        } else if (!lattice.node_at.contains(other)) {
          State& state = empty_[other];
          ++state.known;
          state.has_changed = true;
        }
      }
    }
  }

 private:
  struct State {
    int known = 0;
    bool has_changed = true;
  };
  std::map<Cell, State> empty_;
  int reach_;
};

}  // namespace moiregauge::internal::markers_detail
