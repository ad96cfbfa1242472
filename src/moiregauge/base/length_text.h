// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <tl/expected.hpp>

namespace moiregauge::internal {

// Millimetres from "10mm", "1 cm", "0.01m", "10000um", "10000 µm" or "0.4in"; finite and above zero.
// fails      says what to write; a bare number has no unit and is refused, because guessing one is a factor of 25.4
[[nodiscard]] tl::expected<double, std::string> length_mm(const std::string& text);

}  // namespace moiregauge::internal
