// SPDX-License-Identifier: Apache-2.0
// Conversion of observations to inputs of the bundle adjustment.
#pragma once

#include <optional>
#include <vector>

#include "moiregauge/calibration/scene/frame_series.h"
#include "moiregauge/displacement/method.h"
#include "moiregauge/planning/codec_error.h"

namespace moiregauge::internal {

// Frames for the bundle adjustment. The observations and the reference must outlive them.
struct BundleFrames {
  FrameSeries frames;              // the reference frame first, then frames with enough references
  std::vector<std::size_t> place;  // index of every observation among the frames; 0: not there
};

// Collects the frames with at least `least` references. A reference whose lattice line is uncertain is excluded from
// its frame.
[[nodiscard]] BundleFrames bundle_frames(const Reference& reference, const Observations& observations,
                                         const Camera& camera, const SolveOptions& options, std::size_t least);

// Returns the frame of one observation. Fails (nothing): it has fewer than `least` references.
// `travel`: displacement of each site marker since the reference frame, mm; NaN if not read.
[[nodiscard]] std::optional<BundleFrame> bundle_frame(const Reference& reference, const Observation& seen,
                                                      const Camera& camera,
                                                      const std::vector<Extent<frame::Board>>& travel,
                                                      std::size_t least);

// Returns the frames with the codec's error in their covariance.
[[nodiscard]] FrameSeries with_codec_error(const BundleFrames& all, std::shared_ptr<const CodecHistory> codec);

// Returns the number of references with points in the frame.
[[nodiscard]] std::size_t references_in(const Site& site, const BundleFrame& frame);

}  // namespace moiregauge::internal
