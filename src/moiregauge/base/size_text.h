// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace moiregauge::internal {

// Reads a number of bytes such as "500MB", "20GB" or "2TB" (decimal). Returns nothing for any other text.
[[nodiscard]] std::optional<std::uint64_t> byte_count(const std::string& text);

}  // namespace moiregauge::internal
