// SPDX-License-Identifier: Apache-2.0
// Observations as the calibration takes them.
#pragma once

#include <vector>

#include "moiregauge/calibration/scene/frame_series.h"
#include "moiregauge/displacement/method.h"
#include "moiregauge/planning/codec_error.h"

namespace moiregauge::internal {

// Made from the observations, which must outlive it, as must the reference.
struct BundleFrames {
  FrameSeries frames;              // the reference frame first, then those that show enough references
  std::vector<std::size_t> place;  // of every observation among them; 0: not there
};

// A frame counts from `least` references on; one whose lattice line is in doubt is left out of its frame.
[[nodiscard]] BundleFrames bundle_frames(const Reference& reference, const Observations& observations,
                                         const Camera& camera, const SolveOptions& options, std::size_t least);

// With the codec's error in their covariance.
[[nodiscard]] FrameSeries with_codec_error(const BundleFrames& all, std::shared_ptr<const CodecHistory> codec);

[[nodiscard]] std::size_t references_in(const Site& site, const BundleFrame& frame);

}  // namespace moiregauge::internal
