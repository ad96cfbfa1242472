// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <tl/expected.hpp>

namespace moiregauge::internal {

// Seconds from "18ms", "0.018 s" or "18000us"; finite, zero or above.
// fails      says what to write; a bare number has no unit and is refused
[[nodiscard]] tl::expected<double, std::string> duration_s(const std::string& text);

}  // namespace moiregauge::internal
