// SPDX-License-Identifier: Apache-2.0
// State over frames: the last positions of view and targets, for tracking and phase unwrapping.
#pragma once

#include <cmath>

#include "moiregauge/displacement/sample.h"
#include "moiregauge/observation/frame/observe.h"

namespace moiregauge::internal {

// Unwraps each target's phase over time and predicts positions in the next frame. The fringe order is right if a target
// moves less than half a pitch between two of its frames (checkerboard: a quarter diagonal).
class Follower {
 public:
  explicit Follower(const Reference& reference);
  [[nodiscard]] const Prediction& prediction() const { return prediction_; }
  // Adds a frame's observation. Returns each marker's displacement since the reference frame, mm; NaN if it was not
  // read, or along an axis that the grating does not show.
  std::vector<Extent<frame::Board>> follow(const Reference& reference, const Observation& observation);

 private:
  void expect(const std::vector<Extent<frame::Board>>& last_travel, const std::optional<IdealFromBoard>& last_view);
  Prediction prediction_;
};

// Returns the displacement, or 0 if it is NaN, as a start value.
[[nodiscard]] inline double or_zero(double travel_mm) { return std::isnan(travel_mm) ? 0.0 : travel_mm; }

}  // namespace moiregauge::internal
