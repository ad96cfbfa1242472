// SPDX-License-Identifier: Apache-2.0
// Keeps the published curve continuous while one scene replaces another.
#pragma once

#include <vector>

#include "moiregauge/displacement/method.h"

namespace moiregauge::internal {

// The values of two scenes differ by an offset. It is kept when the scene changes, and then reduced by at most half of u
// per frame. So a change of scene never moves the curve by more than u / 2 from one frame to the next. u contains the
// remaining offset.
class SceneChange {
 public:
  // Begins with a new scene. `before`, `after`: one frame's samples in both scenes, as measured. A target without values
  // in either of them starts without an offset.
  void begin(const Samples& before, const Samples& after);
  // Adds the remaining offsets to the samples of one frame.
  void apply(Samples& samples);

 private:
  std::vector<Extent<frame::Board>> offset_mm_;  // by row
};

}  // namespace moiregauge::internal
