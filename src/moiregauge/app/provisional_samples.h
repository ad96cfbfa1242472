// SPDX-License-Identifier: Apache-2.0
// Provisional samples while a file is measured, so that a curve can grow. They never enter the results.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <vector>

#include "moiregauge/displacement/sample.h"
#include "moiregauge/live/scene_follower.h"
#include "moiregauge/run/frame_sink.h"

namespace moiregauge::internal {

using OnSamples = std::function<void(const Site& site, const std::vector<Sample>& samples)>;

// Follows the observations as a live run does. Frames before the reference frame have no samples. In a fast run, some
// later ones have none either, so that the samples take a bounded share of the time.
class ProvisionalSamples final : public FrameSink {
 public:
  // `next` receives every frame too; null: none. `options` must outlive this object.
  ProvisionalSamples(FrameSink* next, const MeasureOptions& options, OnSamples on_samples);
  ~ProvisionalSamples() override;
  void add(const Frame& frame, int bits, const Reference* reference, const Observation& seen) override;

 private:
  using Clock = std::chrono::steady_clock;
  FrameSink* next_;
  const MeasureOptions& options_;
  OnSamples on_samples_;
  std::unique_ptr<const Reference> reference_;  // a copy, because the run moves its own at the end
  std::unique_ptr<SceneFollower> follower_;
  Clock::time_point next_sample_{};  // when the next sample may be computed
};

}  // namespace moiregauge::internal
