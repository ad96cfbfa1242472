// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/provisional_samples.h"

#include <utility>

namespace moiregauge::internal {

ProvisionalSamples::ProvisionalSamples(FrameSink* next, const MeasureOptions& options, OnSamples on_samples)
    : next_(next), options_(options), on_samples_(std::move(on_samples)) {}

ProvisionalSamples::~ProvisionalSamples() = default;

void ProvisionalSamples::add(const Frame& frame, int bits, const Reference* reference, const Observation& seen) {
  if (next_ != nullptr) next_->add(frame, bits, reference, seen);
  if (reference == nullptr) return;
  if (!follower_) {
    reference_ = std::make_unique<const Reference>(*reference);
    follower_ = std::make_unique<SceneFollower>(*reference_, options_, KeyFrameLimits{});
    // --reference-frame may lie outside the selected frames.
    if (seen.frame != reference_->seen.frame) follower_->replay(reference_->seen);
  }
  on_samples_(reference_->site, follower_->add(seen));
}

}  // namespace moiregauge::internal
