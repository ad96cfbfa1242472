// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <tl/expected.hpp>

namespace moiregauge::internal {

// Reads a length such as "10mm", "1 cm", "0.01m", "10000um", "10000 µm" or "0.4in". Unit of the result: mm, finite,
// above zero.
// Fails with what to write instead. A number without a unit is refused, because a wrong guess is a factor of up to
// 1000.
[[nodiscard]] tl::expected<double, std::string> length_mm(const std::string& text);

}  // namespace moiregauge::internal
