// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/record/alarm_recorder.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

constexpr int kNice = 10;  // measuring has priority over writing

}  // namespace

AlarmRecorder::AlarmRecorder(const RecordOptions& options, MakeRecordingWriter make_writer)
    : options_(options), make_writer_(std::move(make_writer)), thread_([this] { write_all(); }) {}

AlarmRecorder::~AlarmRecorder() { finish(); }

void AlarmRecorder::add(const Frame& frame, int bits, const Reference* reference, const Observation& seen) {
  if (reference == nullptr || frame.damaged || is_finished_) return;
  const bool is_reference = !windows_;
  if (is_reference) {
    windows_.emplace(*reference);
    format_ = {"", width_of(frame.luma), height_of(frame.luma), bits};
  }
  const bool is_full = is_reference || frame.time_s - last_full_s_ >= options_.full_frame_every_s;
  auto stored = store(frame.luma, bits, is_full ? std::vector{whole_frame(frame.luma)} : windows_->in(seen));
  stored.number = frame.number;
  stored.time_s = frame.time_s;
  if (is_full) last_full_s_ = frame.time_s;
  auto shared = std::make_shared<const StoredFrame>(std::move(stored));
  if (is_reference) {
    reference_ = shared;
    return;
  }
  if (!until_s_) return keep(std::move(shared));
  const bool is_last = frame.time_s >= *until_s_;
  post(std::move(shared));
  if (!is_last) return;
  post(End{});
  until_s_.reset();
}

void AlarmRecorder::keep(std::shared_ptr<const StoredFrame> frame) {
  ring_bytes_ += frame->pixels.size();
  const double oldest_s = frame->time_s - options_.seconds;
  ring_.push_back(std::move(frame));
  while (!ring_.empty() && (ring_.front()->time_s < oldest_s || ring_bytes_ > options_.max_bytes)) {
    ring_bytes_ -= ring_.front()->pixels.size();
    ring_.pop_front();
  }
}

void AlarmRecorder::alarm(const AlarmEvent& event) {
  if (!event.is_raised || reference_ == nullptr || is_finished_) return;
  const bool runs_already = until_s_.has_value();
  until_s_ = event.time_s + options_.seconds;
  if (runs_already) return;  // it lasts longer
  format_.name = fmt::format("alarm-{:06}", event.frame);
  post(Begin{format_});
  post(reference_);
  for (auto& frame : ring_) post(std::move(frame));
  ring_.clear();
  ring_bytes_ = 0;
}

void AlarmRecorder::post(Job job) {
  const std::lock_guard lock(mutex_);
  if (const auto* frame = std::get_if<std::shared_ptr<const StoredFrame>>(&job)) {
    if (waiting_bytes_ + (*frame)->pixels.size() > 2 * options_.max_bytes) {
      ++lost_;
      return;
    }
    waiting_bytes_ += (*frame)->pixels.size();
  }
  jobs_.push_back(std::move(job));
  changed_.notify_all();
}

void AlarmRecorder::write_all() {
  // On Linux the priority is that of the thread.
  static_cast<void>(::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNice));
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return !jobs_.empty() || is_closing_; });
    if (jobs_.empty()) return;
    const Job job = std::move(jobs_.front());
    jobs_.pop_front();
    if (const auto* frame = std::get_if<std::shared_ptr<const StoredFrame>>(&job))
      waiting_bytes_ -= (*frame)->pixels.size();
    lock.unlock();
    write(job);
    lock.lock();
  }
}

void AlarmRecorder::write(const Job& job) {
  std::string problem;
  bool is_complete = false;
  if (const auto* begin = std::get_if<Begin>(&job)) {
    auto writer = make_writer_(begin->format);
    if (writer)
      writer_ = std::move(*writer);
    else
      problem = writer.error();
    canvas_.emplace(begin->format.width, begin->format.height, begin->format.bits);
  } else if (const auto* frame = std::get_if<std::shared_ptr<const StoredFrame>>(&job)) {
    if (writer_ == nullptr) return;
    if (auto added = writer_->add(canvas_->show(**frame), (*frame)->time_s); !added) {
      problem = added.error();
      writer_.reset();
    }
  } else if (writer_ != nullptr) {
    auto finished = writer_->finish();
    is_complete = finished.has_value();
    if (!finished) problem = finished.error();
    writer_.reset();
  }
  const std::lock_guard lock(mutex_);
  recordings_ += is_complete ? 1 : 0;
  if (!problem.empty()) problem_ = problem;
}

void AlarmRecorder::finish() {
  if (is_finished_) return;
  is_finished_ = true;
  if (until_s_) post(End{});
  {
    const std::lock_guard lock(mutex_);
    is_closing_ = true;
    changed_.notify_all();
  }
  thread_.join();
}

long AlarmRecorder::recordings() const {
  const std::lock_guard lock(mutex_);
  return recordings_;
}

long AlarmRecorder::lost_frames() const {
  const std::lock_guard lock(mutex_);
  return lost_;
}

std::string AlarmRecorder::problem() const {
  const std::lock_guard lock(mutex_);
  return problem_;
}

}  // namespace moiregauge::internal
