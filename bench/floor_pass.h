// SPDX-License-Identifier: Apache-2.0
// One plain pass over the bytes of a picture: what the machine's memory allows, the floor of everything else.
#pragma once

#include <cstdint>
#include <span>

namespace moiregauge::internal::bench {

[[nodiscard]] std::uint64_t floor_pass(std::span<const std::uint8_t> bytes);

}  // namespace moiregauge::internal::bench
