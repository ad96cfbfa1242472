// SPDX-License-Identifier: Apache-2.0
// Background of the markers: a flat grey, a rough wall, false candidates. It is part of the board and moves with it.
#pragma once

#include <span>
#include <vector>

#include "moiregauge/simulator/rendering/projection.h"
#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal::simulator {

class Background {
 public:
  Background(const Scenario& scenario, long frame);
  // Writes one row in grey levels.
  void fill(int y, std::span<double> row) const;
  [[nodiscard]] const std::vector<SceneMarker>& decoys() const { return decoys_; }

 private:
  Camera camera_;
  double grey_, texture_;
  std::uint64_t seed_;
  std::vector<Matrix3> board_from_ray_;  // one, or one per row for a rolling shutter
  std::vector<SceneMarker> decoys_;
};

}  // namespace moiregauge::internal::simulator
