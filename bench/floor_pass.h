// SPDX-License-Identifier: Apache-2.0
// One pass over the bytes of an image, as the lower limit of the time by memory bandwidth.
#pragma once

#include <cstdint>
#include <span>

namespace moiregauge::internal::bench {

// Returns a checksum of the bytes.
[[nodiscard]] std::uint64_t floor_pass(std::span<const std::uint8_t> bytes);

}  // namespace moiregauge::internal::bench
