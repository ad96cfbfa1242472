// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/provisional_samples.h"

#include <algorithm>
#include <utility>

namespace moiregauge::internal {
namespace {

// Rest after each sample, relative to its duration (chosen): samples then take at most 3 % of the time.
constexpr int kRestAfterSample = 32;
// Longest rest, so that a curve grows at least five times a second whatever its samples take.
constexpr std::chrono::milliseconds kMaxRest(150);

}  // namespace

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
  const auto begin = Clock::now();
  if (begin < next_sample_) {
    follower_->replay(seen);  // keeps the continuity
    return;
  }
  const std::vector<Sample> samples = follower_->add(seen);
  ProvisionalFrame known{seen.frame, reference_->site, samples, std::nullopt};
  if (seen.references_seen) known.reference_from_frame = reference_->seen.stage2 * seen.stage2.inverse();
  on_samples_(known);
  const auto end = Clock::now();
  next_sample_ = end + std::min<Clock::duration>(kRestAfterSample * (end - begin), kMaxRest);
}

}  // namespace moiregauge::internal
