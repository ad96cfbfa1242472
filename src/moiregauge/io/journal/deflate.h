// SPDX-License-Identifier: Apache-2.0
// Bytes compressed by zlib, with their length before them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace moiregauge::internal {

[[nodiscard]] std::string deflated(std::string_view bytes);
// Fails (no value): the bytes are not what `deflated` makes, or stand for more than kMaxInflated.
[[nodiscard]] std::optional<std::string> inflated(std::string_view bytes);
inline constexpr std::size_t kMaxInflated = std::size_t{1} << 24;  // a frame of 10 000 markers

}  // namespace moiregauge::internal
