// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/live/utc_time.h"

#include <cmath>
#include <cstdio>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>

namespace moiregauge::internal {

std::string text_of_utc(std::int64_t utc_ns) {
  constexpr std::int64_t kMsPerS = 1000, kNsPerMs = 1'000'000;
  const std::int64_t ms = utc_ns / kNsPerMs;
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(static_cast<std::time_t>(ms / kMsPerS)), ms % kMsPerS);
}

std::optional<std::int64_t> utc_of_text(const std::string& text) {
  constexpr int kFields = 6, kFirstYear = 1900;
  constexpr double kNsPerS = 1e9;
  std::tm time{};
  double seconds = 0.0;
  if (std::sscanf(text.c_str(), "%d-%d-%dT%d:%d:%lfZ", &time.tm_year, &time.tm_mon, &time.tm_mday, &time.tm_hour,
                  &time.tm_min, &seconds) != kFields)
    return std::nullopt;
  time.tm_year -= kFirstYear;
  time.tm_mon -= 1;
  return static_cast<std::int64_t>(::timegm(&time)) * static_cast<std::int64_t>(kNsPerS) +
         std::llround(seconds * kNsPerS);
}

}  // namespace moiregauge::internal
