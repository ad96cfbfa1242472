// SPDX-License-Identifier: Apache-2.0
// Provisional samples that the camera's processing may have falsified.
#pragma once

#include <deque>

#include "moiregauge/run/camera_processing.h"

namespace moiregauge::internal {

// Applies the tests with which `measure` ends (distrust_processed) to each frame, with the evidence up to this frame.
// `measure` distrusts a moving target in the whole run. Here it is distrusted as long as it moves, and for the longest
// lag of an average over time after it.
class ProcessingDoubt {
 public:
  // Marks the samples of one frame. `processing`: evidence, with the repeated frames since first_frame().
  // `movement`: of this frame.
  void apply(const CameraProcessing& processing, bool is_lossy, const FrameMovement& movement, Samples& samples);
  // Returns the number of the oldest frame that matters.
  [[nodiscard]] long first_frame() const;

 private:
  std::deque<Samples> last_;  // previous frames, as measured
};

}  // namespace moiregauge::internal
