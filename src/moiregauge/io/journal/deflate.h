// SPDX-License-Identifier: Apache-2.0
// Compresses bytes with zlib. Their length comes first.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace moiregauge::internal {

[[nodiscard]] std::string deflated(std::string_view bytes);
// Decompresses. Fails (no value): the bytes are not the output of `deflated`, or would exceed kMaxInflated.
[[nodiscard]] std::optional<std::string> inflated(std::string_view bytes);
inline constexpr std::size_t kMaxInflated = std::size_t{1} << 24;  // bytes: a frame of 10 000 markers

}  // namespace moiregauge::internal
