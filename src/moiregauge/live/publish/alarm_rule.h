// SPDX-License-Identifier: Apache-2.0
// Reads alarm rules, such as "T1.dy > 2 mm for 0.5 s until 1.8 mm" (docs/cli/live.md).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

namespace moiregauge::internal {

// Longest text of a rule, bytes (chosen).
inline constexpr std::size_t kMaxAlarmText = 300;

struct AlarmRule {
  std::string text;  // as typed
  std::string marker;
  bool is_y = true;          // dy; false: dx
  bool is_absolute = false;  // |T1.dy|
  bool is_above = true;      // raised above the level; false: below
  double level_mm = 0.0;
  double release_mm = 0.0;  // beyond it on the safe side the alarm clears. Default: 10 % of the level
  double duration_s = 0.0;  // time for which the condition must hold
};

struct AlarmMistake {
  std::size_t column = 1;  // position of the first wrong byte; the first is 1
  std::string what;        // a full clause
  std::string remedy;      // an imperative
};

// Reads "[|]MARKER.dx|dy[|] >|< LENGTH [for TIME] [until LENGTH]". A name with other characters than letters, digits,
// `_` and `-` is written in double quotes.
// Fails: syntax, a missing unit, a release level on the wrong side of the level, text beyond the limit.
[[nodiscard]] tl::expected<AlarmRule, AlarmMistake> parse_alarm_rule(std::string_view text);

}  // namespace moiregauge::internal
