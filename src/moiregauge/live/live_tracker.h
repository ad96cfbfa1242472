// SPDX-License-Identifier: Apache-2.0
// Measures the frames of a live source one by one, in constant memory: observes as `measure` does, journals, and gives
// provisional samples.
#pragma once

#include <memory>
#include <optional>

#include "moiregauge/live/processing_doubt.h"
#include "moiregauge/live/rate_window.h"
#include "moiregauge/live/scene_follower.h"
#include "moiregauge/run/image_motion.h"
#include "moiregauge/run/live_source.h"
#include "moiregauge/run/observing_run.h"

namespace moiregauge::internal {

class LiveTracker {
 public:
  // Continues `hooks.so_far`. Its frames come again from a recording, or must be replayed by pass_over_kept().
  // `options` must outlive this object.
  LiveTracker(const MeasureOptions& options, const InputInfo& input, RunHooks hooks, KeyFrameLimits limits);

  // Follows the frames of the unfinished run without their images, which a camera cannot show again.
  void pass_over_kept();

  // Measures a frame. Returns nothing for a frame that the unfinished run has measured or lost, and after a
  // contradiction (log().contradiction).
  std::optional<PublishedFrame> measure(const LiveFrame& frame, LiveSource& source);
  // Returns true for a frame that belongs to the unfinished run.
  [[nodiscard]] bool has_passed(const LiveFrame& frame) const {
    return run_.is_kept() || frame.frame.number <= last_kept_;
  }
  // Adds the latency of the frame that was published.
  void published(const PublishedFrame& frame);

  // Returns everything about the run but its observations.
  [[nodiscard]] const Measurement& log() const { return log_; }
  [[nodiscard]] CameraProcessing processing() const { return run_.processing(); }
  // Returns true if no frame of the source can be the reference frame.
  [[nodiscard]] bool cannot_succeed() const { return run_.cannot_succeed() && !log_.reference; }
  [[nodiscard]] bool may_continue() const { return run_.may_continue(); }
  [[nodiscard]] std::size_t key_frames() const { return follower_ ? follower_->key_frames() : 0; }
  [[nodiscard]] LiveHealth health() const { return health_; }
  // Returns facts for the publishers. Requires a reference frame.
  [[nodiscard]] LiveRun description() const;

 private:
  [[nodiscard]] bool has_follower(const Observation& seen);
  void describe_markers(const Observation& seen);

  const MeasureOptions& options_;
  const KeyFrameLimits limits_;
  Measurement log_;
  ObservingRun run_;  // refers to `log_`
  std::unique_ptr<SceneFollower> follower_;
  ProcessingDoubt doubt_;
  ImageMotion motion_;
  bool is_lossy_ = false;
  RateWindow rates_;
  LiveHealth health_;
  long lost_starting_ = 0;
  long last_kept_ = -1;  // number of the last frame of pass_over_kept()
};

}  // namespace moiregauge::internal
