// SPDX-License-Identifier: Apache-2.0
// The one object with a memory: where everything was last, and in which whole turn.
#pragma once

#include <cmath>

#include "moiregauge/displacement/sample.h"
#include "moiregauge/observation/frame/observe.h"

namespace moiregauge::internal {

// Travel of every target since the reference frame, continued from frame to frame into the turn nearest the last one:
// right as long as a target moves less than half a pitch (of its raster: a quarter diagonal for a checkerboard) between
// two frames in which it is seen.
class Follower {
 public:
  explicit Follower(const Reference& reference);
  [[nodiscard]] const Prediction& prediction() const { return prediction_; }
  // Takes the frame's observation in; returns each marker's travel, mm (NaN: not read; on an axis the print cannot
  // show).
  std::vector<Extent<frame::Board>> follow(const Reference& reference, const Observation& observation);

 private:
  void expect(const std::vector<Extent<frame::Board>>& last_travel, const std::optional<IdealFromBoard>& last_view);
  Prediction prediction_;
};

// A number of such a travel, to start or to predict from.
[[nodiscard]] inline double or_zero(double travel_mm) { return std::isnan(travel_mm) ? 0.0 : travel_mm; }

}  // namespace moiregauge::internal
