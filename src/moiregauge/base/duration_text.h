// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <tl/expected.hpp>

namespace moiregauge::internal {

// Reads a duration such as "18ms", "0.018 s" or "18000us". Unit of the result: s, finite, zero or above.
// Fails with what to write instead. A number without a unit is refused.
[[nodiscard]] tl::expected<double, std::string> duration_s(const std::string& text);

// Reads a duration such as "30s", "10min", "1h" or "30d", as duration_s does.
[[nodiscard]] tl::expected<double, std::string> long_duration_s(const std::string& text);

}  // namespace moiregauge::internal
