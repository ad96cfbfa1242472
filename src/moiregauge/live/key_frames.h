// SPDX-License-Identifier: Apache-2.0
// Bounded choice of frames from which a scene is solved.
#pragma once

#include <cstddef>
#include <limits>

#include "moiregauge/observation/reference/observations.h"

namespace moiregauge::internal {

struct KeyFrameLimits {
  std::size_t max_frames = 128;
  // Older key frames are dropped, so that the scene follows a lens that drifts with temperature.
  double max_age_s = std::numeric_limits<double>::infinity();
};

// Keeps frames at an even stride. With too many frames the stride doubles, until the frames span `max_age_s`. From then
// on the oldest one is dropped.
class KeyFrames {
 public:
  explicit KeyFrames(KeyFrameLimits limits = {}) : limits_(limits) {}
  void refer_to(const Reference& reference) { frames_.refer_to(reference); }
  // Adds the frame if it is at the stride or if `is_wanted`. Returns true if it was kept.
  bool add(const Observation& seen, bool is_wanted = false);
  [[nodiscard]] const Observations& frames() const { return frames_; }
  // Returns the number of frames kept since the start, dropped ones included.
  [[nodiscard]] long added() const { return added_; }

 private:
  void thin();
  void drop_oldest();

  KeyFrameLimits limits_;
  Observations frames_;
  long seen_ = 0;
  long stride_ = 1;
  long added_ = 0;
};

}  // namespace moiregauge::internal
