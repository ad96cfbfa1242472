// SPDX-License-Identifier: Apache-2.0
// Light on the sensor: vignetting, slopes, flicker, and reflections of lamps.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal::simulator {

class Lighting {
 public:
  Lighting(const Scenario& scenario, long frame);
  // Returns the brightness of a row, 1 without flicker.
  [[nodiscard]] double brightness_of(int y) const {
    return brightness_[brightness_.size() > 1 ? static_cast<std::size_t>(y) : 0];
  }
  // Applies the light to pixels from..to - 1 of row y, in grey levels.
  void fall_on(int y, int from, int to, std::span<double> row) const;

 private:
  // Reflection of a lamp in the image.
  struct Spot {
    double x, y;   // px
    double sigma;  // px
    double grey;   // grey levels at its middle
  };
  void find_spots(const Scenario& scenario, long frame);
  // Returns vignetting and slopes at a pixel, relative to the centre of the image.
  [[nodiscard]] double share_at(int x, int y) const;

  double vignetting_, slope_x_, slope_y_, middle_x_, middle_y_, corner2_;
  std::vector<double> brightness_;  // per row, or one value for all rows
  std::vector<Spot> spots_;
};

}  // namespace moiregauge::internal::simulator
