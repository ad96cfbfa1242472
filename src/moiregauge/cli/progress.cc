// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/progress.h"

#include <unistd.h>

#include <cstdio>
#include <utility>

#include <fmt/format.h>

namespace moiregauge::cli {
namespace {

constexpr double kQuietSeconds = 2.0;
constexpr double kRefreshSeconds = 0.2;
constexpr int kBarWidth = 24;

double seconds(std::chrono::steady_clock::duration d) { return std::chrono::duration<double>(d).count(); }

}  // namespace

Progress::Progress(std::string what, bool quiet)
    : what_(std::move(what)), wanted_(!quiet && ::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (shown_) fmt::print(stderr, "\r\x1b[K");
}

void Progress::show(long done, long expected) {
  if (!wanted_) return;
  const auto now = Clock::now();
  if (seconds(now - start_) < kQuietSeconds || seconds(now - last_) < kRefreshSeconds) return;
  last_ = now;
  shown_ = true;
  const double rate = double(done) / seconds(now - start_);
  if (expected > 0) {
    const int filled = static_cast<int>(kBarWidth * done / expected);
    fmt::print(stderr, "\r\x1b[K{} [{}{}] {}/{} frames, {:.1f}/s, {:.0f} s left", what_, std::string(size_t(filled), '#'),
               std::string(size_t(kBarWidth - filled), '.'), done, expected, rate, double(expected - done) / rate);
  } else {
    fmt::print(stderr, "\r\x1b[K{} {} frames, {:.1f}/s", what_, done, rate);
  }
  std::fflush(stderr);
}

}  // namespace moiregauge::cli
