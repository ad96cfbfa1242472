// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/paced_source.h"

#include <utility>

#include <fmt/format.h>

#include "moiregauge/live/clocks.h"

namespace moiregauge::internal {
namespace {

using Clock = std::chrono::steady_clock;

SourceEnd end_of(const tl::expected<std::optional<Frame>, InputError>& frame) {
  return {SourceEnd::Kind::kFinished, frame ? std::string{} : frame.error().message};
}

}  // namespace

PacedSource::PacedSource(std::unique_ptr<FrameSource> recording, double pace, long passed, int queued)
    : recording_(std::move(recording)),
      pace_(pace),
      passed_(passed),
      info_(recording_->info()),
      queue_(queued),
      thread_([this](const std::stop_token& stop) { deliver(stop); }) {}

bool PacedSource::wait_until(Clock::time_point due, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  stopped_.wait_until(lock, stop, due, [] { return false; });
  return !stop.stop_requested();
}

void PacedSource::deliver(const std::stop_token& stop) {
  std::optional<Clock::time_point> start;  // due time of the first frame that is not passed over
  double first_s = 0.0;
  while (!stop.stop_requested()) {
    const auto frame = recording_->next();
    if (!frame || !*frame) {
      final_info_ = recording_->info();
      queue_.end(end_of(frame));
      return;
    }
    LiveFrame live;
    live.frame = **frame;
    // The pixels are copied before they are measured. A recording that was truncated meanwhile counts as damaged.
    live.frame.damaged = live.frame.damaged || !recording_->is_frame_whole();
    if (live.frame.number <= passed_) {
      live.host_ns = steady_ns();
      if (!queue_.put_waiting(live, stop)) return;
      continue;
    }
    if (!start) {
      start = Clock::now();
      first_s = live.frame.time_s;
    }
    const std::chrono::duration<double> after((live.frame.time_s - first_s) / pace_);
    if (!wait_until(*start + std::chrono::duration_cast<Clock::duration>(after), stop)) return;
    live.host_ns = steady_ns();
    (void)queue_.put(live);
  }
}

tl::expected<std::optional<LiveFrame>, SourceEnd> PacedSource::next(std::chrono::milliseconds timeout) {
  auto frame = queue_.take(timeout);
  if (!frame && final_info_) info_ = *std::exchange(final_info_, std::nullopt);
  return frame;
}

std::vector<std::pair<std::string, std::string>> PacedSource::settings() const {
  return {{"pace", fmt::format("{}", pace_)}, {"queued_frames", fmt::format("{}", kQueuedFrames)}};
}

tl::expected<std::optional<LiveFrame>, SourceEnd> UnpacedSource::next(std::chrono::milliseconds /*timeout*/) {
  if (end_) return tl::unexpected(*end_);
  const auto frame = recording_->next();
  if (!frame || !*frame) {
    end_ = end_of(frame);
    return tl::unexpected(*end_);
  }
  LiveFrame live;
  live.frame = **frame;
  live.host_ns = steady_ns();
  return live;
}

}  // namespace moiregauge::internal
