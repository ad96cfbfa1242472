// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace moiregauge::internal {

// Frames A:B:STEP of an input. B is excluded.
struct FrameRange {
  long first = 0;
  long end = -1;  // -1: to the end
  long step = 1;
  [[nodiscard]] bool holds(long frame) const {
    return frame >= first && (end < 0 || frame < end) && (frame - first) % step == 0;
  }
};

}  // namespace moiregauge::internal
