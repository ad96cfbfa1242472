// SPDX-License-Identifier: Apache-2.0
// The light that falls on the sensor: how bright the scene is lit where and when, and what lamps mirrored in it add.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal::simulator {

class Lighting {
 public:
  Lighting(const Scenario& scenario, long frame);
  // What all pixels of a row share, relative to no flicker.
  [[nodiscard]] double brightness_of(int y) const {
    return brightness_[brightness_.size() > 1 ? static_cast<std::size_t>(y) : 0];
  }
  // Lights pixels from..to of row y, in grey levels.
  void fall_on(int y, int from, int to, std::span<double> row) const;

 private:
  // A spot in the picture.
  struct Spot {
    double x, y;   // px
    double sigma;  // px
    double grey;   // at its middle
  };
  void find_spots(const Scenario& scenario, long frame);
  // Relative to the centre of the picture.
  [[nodiscard]] double share_at(int x, int y) const;

  double vignetting_, slope_x_, slope_y_, middle_x_, middle_y_, corner2_;
  std::vector<double> brightness_;  // of every row, or one for all
  std::vector<Spot> spots_;
};

}  // namespace moiregauge::internal::simulator
