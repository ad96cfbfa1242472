// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/live/live_samples.h"

#include <chrono>
#include <condition_variable>
#include <mutex>

#include "moiregauge/cli/common/terminal_text.h"

namespace moiregauge::internal::cli {
namespace {

constexpr std::chrono::milliseconds kWriteEvery(100);

}  // namespace

LiveSamples::LiveSamples() : thread_([this](const std::stop_token& stop) { work(stop); }) {}

void LiveSamples::start(const LiveRun& run) {
  const std::lock_guard lock(mutex_);
  markers_ = run.markers;
}

void LiveSamples::put(const PublishedFrame& frame) {
  const std::lock_guard lock(mutex_);
  if (markers_.empty()) return;
  for (const Sample& sample : frame.rows) rows_.keep(markers_[sample.marker], sample);
}

void LiveSamples::finish(double) {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  write();
}

void LiveSamples::write() {
  std::string lines;
  {
    const std::lock_guard lock(mutex_);
    lines = rows_.take();
  }
  print_note(lines);
}

void LiveSamples::work(const std::stop_token& stop) {
  std::mutex sleeping;
  std::condition_variable_any stopped;
  std::unique_lock lock(sleeping);
  while (!stopped.wait_for(lock, stop, kWriteEvery, [&] { return stop.stop_requested(); })) write();
}

}  // namespace moiregauge::internal::cli
