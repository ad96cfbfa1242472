// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace moiregauge::internal {

// Returns a time such as "2026-05-04T09:12:33.250Z". `utc_ns`: ns since 1970.
[[nodiscard]] std::string text_of_utc(std::int64_t utc_ns);
// Returns the time of such a text, ns since 1970.
[[nodiscard]] std::optional<std::int64_t> utc_of_text(const std::string& text);

}  // namespace moiregauge::internal
