// SPDX-License-Identifier: Apache-2.0
// Provisional samples while a file is measured, so that a curve can grow. They never enter the results.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "moiregauge/displacement/sample.h"
#include "moiregauge/geometry/homography.h"
#include "moiregauge/live/scene_follower.h"
#include "moiregauge/run/frame_sink.h"

namespace moiregauge::internal {

// A frame with its provisional samples.
struct ProvisionalFrame {
  long frame;
  const Site& site;
  const std::vector<Sample>& samples;
  // Map from image points (px) of this frame to those of the reference frame, by the references. It includes no lens
  // distortion, so it is for pictures only. Nothing: the references are not seen.
  std::optional<Homography<frame::Ideal, frame::Ideal>> reference_from_frame;
};

using OnSamples = std::function<void(const ProvisionalFrame&)>;

// Follows the observations as a live run does. Frames before the reference frame have no samples. In a fast run, some
// later ones have none either, so that the samples take a bounded share of the time.
class ProvisionalSamples final : public FrameSink {
 public:
  // `next` receives every frame too; null: none. `options` must outlive this object.
  ProvisionalSamples(FrameSink* next, const MeasureOptions& options, OnSamples on_samples);
  ProvisionalSamples(const ProvisionalSamples&) = delete;
  ProvisionalSamples& operator=(const ProvisionalSamples&) = delete;
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
