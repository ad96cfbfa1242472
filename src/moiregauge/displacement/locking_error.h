// SPDX-License-Identifier: Apache-2.0
// Adds pixel locking to the covariance of the points (docs/methods/precise/uncertainty.md).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "moiregauge/calibration/scene/frame_series.h"
#include "moiregauge/observation/print/pixel_locking.h"
#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

class LockingError {
 public:
  // Estimates the amplitude of each marker from its template, and from residuals that change with the position relative
  // to the pixels. `frames`: the reference frame first. The reference must outlive this object.
  LockingError(const Reference& reference, const FrameSeries& frames);

  [[nodiscard]] bool is_zero() const;
  // Returns the amplitudes of a marker along X and Y, pitches.
  [[nodiscard]] LockingAmplitude amplitude(std::size_t marker) const { return markers_[marker].amplitude; }
  // Returns the frame with the error in the common term of the nine points.
  [[nodiscard]] BundleFrame with_error(BundleFrame frame) const;
  // Returns a warning if a target's error can exceed its noise by far.
  [[nodiscard]] std::optional<std::string> note() const;

 private:
  struct OfMarker {
    LockingAmplitude amplitude{};
    PixelPhase at_rest{};
  };
  const Reference& reference_;
  std::vector<OfMarker> markers_;  // one per site marker
};

// Returns the frames with this error.
[[nodiscard]] FrameSeries with_locking_error(const FrameSeries& frames, std::shared_ptr<const LockingError> error);

}  // namespace moiregauge::internal
