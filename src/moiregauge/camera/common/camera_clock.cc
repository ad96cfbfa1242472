// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/camera/common/camera_clock.h"

#include <algorithm>
#include <cstdlib>

namespace moiregauge::internal {
namespace {

// Two clocks of one machine drift apart by less than 1 s in a gap between two frames. A reset differs by more (chosen).
constexpr std::int64_t kReset_ns = 1'000'000'000;

}  // namespace

double CameraClock::time_s(std::optional<std::int64_t> device_ns, std::int64_t host_ns) {
  const bool has_device = device_ns && *device_ns > 0;
  std::int64_t time_ns = 0;
  if (anchor_) {
    const std::int64_t host_step = std::max<std::int64_t>(host_ns - last_host_ns_, 1);
    const std::int64_t device_step = has_device && anchor_->has_device ? *device_ns - last_device_ns_ : -1;
    const bool is_reset = device_step <= 0 || std::llabs(device_step - host_step) > kReset_ns;
    if (is_reset && has_device) anchor_ = Anchor{*device_ns, host_ns, last_time_ns_ + host_step, true};
    time_ns = !has_device ? last_time_ns_ + host_step : anchor_->time_ns + *device_ns - anchor_->device_ns;
    time_ns = std::max(time_ns, last_time_ns_ + 1);
    if (!has_device) anchor_->has_device = false;
  } else {
    anchor_ = Anchor{device_ns.value_or(0), host_ns, 0, has_device};
  }
  last_device_ns_ = device_ns.value_or(0);
  last_host_ns_ = host_ns;
  last_time_ns_ = time_ns;
  return static_cast<double>(time_ns) * 1e-9;
}

long FrameCounter::number_of(std::uint64_t id) {
  if (last_id_) {
    // GigE Vision 1.x counts from 1 to 65535 and skips 0.
    constexpr std::uint64_t kWrap = 65535;
    const bool has_wrapped = id <= *last_id_ && *last_id_ <= kWrap;
    const std::uint64_t step = id > *last_id_ ? id - *last_id_ : has_wrapped ? id + kWrap - *last_id_ : 1;
    constexpr std::uint64_t kMaxGap = 32768;  // half the range: a larger step is a reset of the counter
    if (step <= kMaxGap) {
      next_ += static_cast<long>(step) - 1;
      missing_ += static_cast<long>(step) - 1;
    }
  }
  last_id_ = id;
  return next_++;
}

}  // namespace moiregauge::internal
