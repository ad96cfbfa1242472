// SPDX-License-Identifier: Apache-2.0
// Characters that steer a terminal, or the direction of text, instead of being shown: a file's name may hold them.
#pragma once

#include <string>
#include <string_view>

namespace moiregauge::internal {

// Has the text a C0 or C1 control, DEL, or a mark that changes the direction of text (U+202A to U+202E, U+2066 to U+2069,
// U+200E, U+200F, U+061C)? Bytes that are no UTF-8 count as well: 0x9B alone is a control of 8-bit terminals.
[[nodiscard]] bool has_control_character(std::string_view text);

// Returns the text with each of them as "\u001b", or "\x9b" for a byte that is no UTF-8. Line feeds and tabs stay.
[[nodiscard]] std::string with_controls_escaped(std::string_view text);

}  // namespace moiregauge::internal
