// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/rate_window.h"

#include <algorithm>
#include <cmath>

namespace moiregauge::internal {
namespace {

// In frames. The first ones update at once.
constexpr std::size_t kUpdateEvery = 16, kFirst = 64;

}  // namespace

void RateWindow::add(std::int64_t complete_ns, std::int64_t ready_ns) {
  constexpr double kNsPerMs = 1e6;
  const std::size_t at = count_ % kFrames;
  latency_ms_[at] = static_cast<double>(ready_ns - complete_ns) / kNsPerMs;
  complete_ns_[at] = complete_ns;
  if (count_++ % kUpdateEvery == 0 || count_ <= kFirst) update();
}

void RateWindow::update() {
  constexpr double kNsPerS = 1e9, kP50 = 0.5, kP99 = 0.99;
  const std::size_t size = std::min(count_, kFrames);
  auto sorted = latency_ms_;
  std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(size));
  const auto quantile = [&](double share) {
    return sorted[static_cast<std::size_t>(std::lround(share * double(size - 1)))];
  };
  p50_ms_ = quantile(kP50);
  p99_ms_ = quantile(kP99);
  const std::size_t newest = (count_ - 1) % kFrames;
  const std::size_t oldest = count_ > kFrames ? count_ % kFrames : 0;
  const auto span_ns = static_cast<double>(complete_ns_[newest] - complete_ns_[oldest]);
  if (size > 1 && span_ns > 0.0) per_s_ = kNsPerS * static_cast<double>(size - 1) / span_ns;
}

void RateWindow::describe(LiveHealth& health) const {
  health.latency_p50_ms = p50_ms_;
  health.latency_p99_ms = p99_ms_;
  health.frames_per_s = per_s_;
}

}  // namespace moiregauge::internal
