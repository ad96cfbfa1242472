// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include <fmt/format.h>

namespace moiregauge::cli {
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

}  // namespace moiregauge::cli
