// SPDX-License-Identifier: Apache-2.0
// Reads a part of a recording as typed: frames `10:20`, or seconds `1.5s:3s`, half open. Every option that selects
// frames uses it.
#pragma once

#include <string>

#include <tl/expected.hpp>

#include "moiregauge/app/measure_options.h"
#include "moiregauge/units/frame_range.h"

namespace moiregauge::internal {

struct RangeOption {
  const char* name;       // "--rest"
  const char* example;    // "0:20"
  bool has_step = false;  // A:B:STEP is allowed
};
inline constexpr RangeOption kFramesOption{"--frames", "0:100:2", true};
inline constexpr RangeOption kRestOption{"--rest", "0:20"};
inline constexpr RangeOption kZeroOption{"--zero", "0:30"};
inline constexpr RangeOption kTimeOption{"--time", "2:8.5"};  // seconds

// Returns the range in `text`. An end may be missing. Seconds have a unit (s, ms, us), at both ends; 0 needs none.
// Fails: the line names the option and what to write.
[[nodiscard]] tl::expected<FrameRange, UsageError> frame_range_in(const std::string& text, const RangeOption& option);

// Returns a range in seconds, for an option whose bare numbers are seconds.
// Fails: as frame_range_in.
[[nodiscard]] tl::expected<FrameRange, UsageError> seconds_in_range(const std::string& text, const RangeOption& option);

}  // namespace moiregauge::internal
