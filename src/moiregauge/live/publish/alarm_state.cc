// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/publish/alarm_state.h"

#include <algorithm>
#include <cmath>

namespace moiregauge::internal {
namespace {

constexpr double kMinClear_s = 1.0;   // chosen: longer than a period of most bridges
constexpr double kRounding_s = 1e-6;  // error of time stamps

}  // namespace

AlarmChange AlarmState::step(double time_s, double value_mm) {
  if (!std::isfinite(value_mm) || !std::isfinite(time_s)) return AlarmChange::kNone;
  const double value = rule_.is_absolute ? std::fabs(value_mm) : value_mm;
  const bool is_beyond = rule_.is_above ? value > rule_.level_mm : value < rule_.level_mm;
  const bool is_safe = rule_.is_above ? value <= rule_.release_mm : value >= rule_.release_mm;
  const double hold_s = is_raised_ ? std::max(rule_.duration_s, kMinClear_s) : rule_.duration_s;
  const bool would_change = is_raised_ ? is_safe : is_beyond;
  const bool has_gap = since_s_ && time_s - last_s_ > hold_s + kRounding_s;
  last_s_ = time_s;
  if (!would_change) {
    since_s_.reset();
    return AlarmChange::kNone;
  }
  if (!since_s_ || has_gap) since_s_ = time_s;
  if (time_s - *since_s_ + kRounding_s < hold_s) return AlarmChange::kNone;
  since_s_.reset();
  is_raised_ = !is_raised_;
  return is_raised_ ? AlarmChange::kRaised : AlarmChange::kCleared;
}

}  // namespace moiregauge::internal
