// SPDX-License-Identifier: Apache-2.0
// The empty cells round a lattice that grows, and which of them are worth another look. Looking at all of them, and
// finding them from all points, each time would cost the points' number to the power of 1.5.
#pragma once

#include <cstdlib>
#include <map>
#include <utility>
#include <vector>

#include "moiregauge/detection/lattices/lattice_growth.h"

namespace moiregauge::internal::markers_detail {

class LatticeFrontier {
 public:
  // `reach`: how many cells away an added point changes the prediction for an empty cell.
  LatticeFrontier(const GrownLattice& lattice, int reach) : reach_(reach) {
    for (const auto& [cell, node] : lattice.node_at) add(lattice, cell);
  }

  // Returns the empty cells with at least `support` known ones of the eight round them, in order.
  [[nodiscard]] std::vector<Cell> cells(int support) const {
    std::vector<Cell> found;
    for (const auto& [cell, state] : empty_) {
      if (state.known >= support) found.push_back(cell);
    }
    return found;
  }

  // Has a point near this empty cell been added since it was looked at? What was seen there would be the same otherwise.
  [[nodiscard]] bool take_change(Cell cell) {
    const auto found = empty_.find(cell);
    return found != empty_.end() && std::exchange(found->second.has_changed, false);
  }

  // Call after the lattice has taken this cell.
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
