// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/live_tracker.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "moiregauge/displacement/sample_parts.h"
#include "moiregauge/live/clocks.h"
#include "moiregauge/run/codec.h"

namespace moiregauge::internal {
namespace {

// Returns the smaller value, or the one that is known.
double lower(double a, double b) { return std::isnan(a) ? b : std::isnan(b) ? a : std::min(a, b); }
double higher(double a, double b) { return std::isnan(a) ? b : std::isnan(b) ? a : std::max(a, b); }

// Returns the modulation relative to the reference frame, the lower one of both axes. NaN: not read.
double modulation_of(const MarkerObservation& then, const MarkerObservation& now) {
  double share = kNotMeasured;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (now.points && now.points->fundamental[axis] > 0.0) share = lower(share, now.points->fundamental[axis]);
    if (!now.points && now.patch.valid && then.patch.modulation[axis] > 0.0)
      share = lower(share, now.patch.modulation[axis] / then.patch.modulation[axis]);
  }
  return share;
}

}  // namespace

LiveTracker::LiveTracker(const MeasureOptions& options, const InputInfo& input, RunHooks hooks, KeyFrameLimits limits)
    : options_(options), limits_(limits), run_(options, log_, std::move(hooks), Keep::kNone) {
  log_.input = input;
}

// Returns true for the reference frame and later ones.
bool LiveTracker::has_follower(const Observation& seen) {
  if (!follower_ && log_.reference && seen.frame >= log_.reference->seen.frame)
    follower_ = std::make_unique<SceneFollower>(*log_.reference, options_, limits_);
  return follower_ != nullptr;
}

void LiveTracker::pass_over_kept() {
  while (run_.is_kept()) {
    const Observation seen = run_.pass_over_unseen();
    last_kept_ = seen.frame;
    if (has_follower(seen)) follower_->replay(seen);
  }
  if (follower_) follower_->solve_replayed();
}

void LiveTracker::describe_markers(const Observation& seen) {
  health_.clipped = health_.modulation = kNotMeasured;
  for (std::size_t i = 0; i < seen.markers.size(); ++i) {
    const MarkerObservation& now = seen.markers[i];
    if (!log_.reference->site.markers[i].grating || now.loss != Loss::kNone) continue;
    health_.clipped = higher(health_.clipped, now.patch.valid ? now.patch.clipped_share : kNotMeasured);
    health_.modulation = lower(health_.modulation, modulation_of(log_.reference->seen.markers[i], now));
  }
}

std::optional<PublishedFrame> LiveTracker::measure(const LiveFrame& frame, LiveSource& source) {
  if (run_.is_kept()) {
    if (const auto seen = run_.pass_over(frame.frame); seen && has_follower(*seen)) follower_->replay(*seen);
    if (!run_.is_kept() && follower_) follower_->solve_replayed();
    return std::nullopt;
  }
  if (frame.frame.number <= last_kept_) {
    run_.keep_picture(frame.frame);
    return std::nullopt;
  }
  PublishedFrame out{frame.frame.number, frame.frame.time_s, frame.device_ns, frame.host_ns, 0, {}, {}, {}};
  out.utc_ns = utc_ns() - (steady_ns() - frame.host_ns);
  const bool had_reference = log_.reference.has_value();
  const auto seen = run_.measure_frame(frame.frame, [&source] { return source.is_frame_whole(); });
  if (!seen) return std::nullopt;
  if (has_follower(*seen)) out.rows = follower_->add(*seen);
  is_lossy_ = is_lossy_ || is_lossy(*seen);
  const FrameMovement movement = log_.reference ? motion_.add(*log_.reference, *seen) : FrameMovement{};
  doubt_.apply(run_.processing(doubt_.first_frame()), is_lossy_, movement, out.rows);
  if (!seen->references_seen) out.problem = seen->reference_problem;
  if (log_.reference) describe_markers(*seen);
  ++health_.frames;
  health_.lost = source.lost();
  if (!had_reference) lost_starting_ = health_.lost.queue_full;
  health_.lost.starting = lost_starting_;
  health_.lost.queue_full -= lost_starting_;
  health_.queued = frame.queued;
  health_.rows += static_cast<long>(out.rows.size());
  health_.ok_rows += std::ranges::count(out.rows, Status::kOk, &Sample::status);
  health_.scenes = follower_ ? follower_->scenes() : 0;
  out.health = health_;
  return out;
}

void LiveTracker::published(const PublishedFrame& frame) {
  rates_.add(frame.host_ns, steady_ns());
  rates_.describe(health_);
}

LiveRun LiveTracker::description() const {
  LiveRun run;
  run.source = log_.input.path;
  run.reference_frame = log_.reference->seen.frame;
  for (const Marker& marker : log_.reference->site.markers) {
    if (is_target(*log_.reference, run.markers.size())) run.targets.push_back(run.markers.size());
    run.markers.push_back(marker.name);
  }
  return run;
}

}  // namespace moiregauge::internal
