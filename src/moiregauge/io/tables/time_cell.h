// SPDX-License-Identifier: Apache-2.0
// Times as data loggers write them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace moiregauge::internal {

struct ClockTime {
  double seconds = 0.0;  // since 1970 with a date, otherwise since midnight
  bool has_date = false;
};

// Reads "2026-11-25T10:00:00.25Z", "2026-11-25 10:00:00", "25.11.2026 10:00:00,25" or "10:00:00.25". A zone ("Z",
// "+02:00") may follow a date. Returns nothing for another text, such as a date with slashes, whose order is unknown.
[[nodiscard]] std::optional<ClockTime> clock_time(std::string_view text);

// Returns the seconds of a unit: s, ms, us, min or h. Nothing: another word.
[[nodiscard]] std::optional<double> seconds_of_unit(std::string_view unit);

// Returns the unit at the end of a column's name: "time_ms", "Time [ms]", "t (min)", "t/h", or a unit alone. Nothing: it names none.
[[nodiscard]] std::optional<std::string> time_unit_in(std::string_view name);

}  // namespace moiregauge::internal
