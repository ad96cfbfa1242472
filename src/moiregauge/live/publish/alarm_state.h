// SPDX-License-Identifier: Apache-2.0
// State of one alarm over time.
#pragma once

#include <optional>

#include "moiregauge/live/publish/alarm_rule.h"

namespace moiregauge::internal {

enum class AlarmChange { kNone, kRaised, kCleared };

// An alarm is raised once its condition has held for the rule's duration. It clears once the value has been on the safe
// side of the release level for as long, at least 1 s. So a vibration does not raise it once per period.
//
// A value that was not measured proves neither. A gap longer than that time restarts the time. A raised alarm remains
// raised while nothing is measured.
class AlarmState {
 public:
  explicit AlarmState(const AlarmRule& rule) : rule_(rule) {}
  // Adds a value in mm; NaN: not measured. Times must not decrease.
  [[nodiscard]] AlarmChange step(double time_s, double value_mm);
  [[nodiscard]] bool is_raised() const { return is_raised_; }
  [[nodiscard]] const AlarmRule& rule() const { return rule_; }

 private:
  AlarmRule rule_;
  bool is_raised_ = false;
  std::optional<double> since_s_;  // the condition for a change has held since
  double last_s_ = 0.0;            // time of the last measured value
};

}  // namespace moiregauge::internal
