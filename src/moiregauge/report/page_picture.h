// SPDX-License-Identifier: Apache-2.0
// A picture as a page for people needs it: no larger than it is shown, so that the page can be sent by mail.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace moiregauge::internal {

// A PNG's picture as a JPEG, at most 1600 px wide; the PNG itself where that is smaller or cannot be read.
[[nodiscard]] std::vector<std::uint8_t> page_picture(std::span<const std::uint8_t> png);

}  // namespace moiregauge::internal
