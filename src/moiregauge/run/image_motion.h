// SPDX-License-Identifier: Apache-2.0
// Motion of the references in the image, from frame to frame.
#pragma once

#include <deque>
#include <vector>

#include "moiregauge/displacement/method.h"
#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// Longest lag of an average over time, in samples (chosen).
inline constexpr std::size_t kLagSamples = 8;

// Returns the centres of the reference circles in a frame, px, by its homography. Requires references_seen.
[[nodiscard]] std::vector<ImagePoint> reference_centres(const Reference& reference, const Observation& seen);

// Returns the largest distance between two centres of the same circle, px.
[[nodiscard]] double largest_distance(const std::vector<ImagePoint>& a, const std::vector<ImagePoint>& b);

// Largest movement of a reference in the image within the last kLagSamples frames.
struct FrameMovement {
  long frame = 0;
  double pitches = 0.0;  // unit: smallest pitch of the site; infinite if the references were not seen
};

// Follows the references from frame to frame.
class ImageMotion {
 public:
  // Adds a measured frame. Call it in frame order.
  FrameMovement add(const Reference& reference, const Observation& seen);

 private:
  double pitch_px_ = 0.0;                     // smallest pitch of the site; 0 before the first frame
  std::deque<std::vector<ImagePoint>> last_;  // px, newest first
};

// Returns the movement in each frame.
[[nodiscard]] std::vector<FrameMovement> movement_in_frames(const Reference& reference,
                                                            const Observations& observations);

}  // namespace moiregauge::internal
