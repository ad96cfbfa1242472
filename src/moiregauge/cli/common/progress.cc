// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/common/progress.h"

#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <utility>

#include <fmt/format.h>

namespace moiregauge::internal::cli {
namespace {

constexpr double kQuietSeconds = 2.0;
constexpr double kRefreshSeconds = 0.2;
constexpr std::size_t kBarWidth = 24;

double seconds(std::chrono::steady_clock::duration d) { return std::chrono::duration<double>(d).count(); }

std::string rate_text(double per_s) {
  return per_s < 10.0 ? fmt::format("{:.1f}", per_s) : fmt::format("{:.0f}", per_s);
}

}  // namespace

std::string progress_line(const std::string& what, const ProgressState& state) {
  const double rate = static_cast<double>(state.done) / state.elapsed_s;
  const char* limit = !state.waiting_share ? "" : *state.waiting_share > 0.5 ? "decode-bound, " : "measuring-bound, ";
  if (state.expected <= 0) return fmt::format("{} {} frames, {}{} fps", what, state.done, limit, rate_text(rate));
  const auto filled = kBarWidth * static_cast<std::size_t>(std::min(state.done, state.expected)) /
                      static_cast<std::size_t>(state.expected);
  return fmt::format("{} [{}{}] {}/{} frames, {}{} fps, {:.0f} s left", what, std::string(filled, '#'),
                     std::string(kBarWidth - filled, '.'), state.done, state.expected, limit, rate_text(rate),
                     static_cast<double>(std::max(0L, state.expected - state.done)) / rate);
}

Progress::Progress(std::string what, bool quiet)
    : what_(std::move(what)), wanted_(!quiet && ::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (shown_) fmt::print(stderr, "\r\x1b[K");
}

void Progress::show(long done, long expected, std::optional<double> waiting_share) {
  if (!wanted_) return;
  const auto now = Clock::now();
  if (seconds(now - start_) < kQuietSeconds || seconds(now - last_) < kRefreshSeconds) return;
  last_ = now;
  shown_ = true;
  fmt::print(stderr, "\r\x1b[K{}", progress_line(what_, {done, expected, seconds(now - start_), waiting_share}));
  std::fflush(stderr);
}

ElapsedLine::ElapsedLine(std::string what, bool quiet) {
  if (quiet || ::isatty(STDERR_FILENO) != 1) return;
  thread_ = std::jthread([what = std::move(what)](const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any stopped;
    std::unique_lock lock(mutex);
    for (long s = 1; !stopped.wait_for(lock, stop, std::chrono::seconds(1), [&] { return stop.stop_requested(); });
         ++s) {
      fmt::print(stderr, "\r\x1b[K{}, {} s", what, s);
      std::fflush(stderr);
    }
    fmt::print(stderr, "\r\x1b[K");
    std::fflush(stderr);
  });
}

}  // namespace moiregauge::internal::cli
