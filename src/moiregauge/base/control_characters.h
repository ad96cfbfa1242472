// SPDX-License-Identifier: Apache-2.0
// Control characters of terminals and of text direction. A file name may contain them.
#pragma once

#include <string>
#include <string_view>

namespace moiregauge::internal {

// Returns true if the text contains a C0 or C1 control, DEL, or a mark of text direction.
// Such marks are U+202A to U+202E, U+2066 to U+2069, U+200E, U+200F and U+061C.
// Invalid UTF-8 counts as well, because 0x9B alone is a control of 8-bit terminals.
[[nodiscard]] bool has_control_character(std::string_view text);

// Returns the text with controls as "\u001b" and bytes of invalid UTF-8 as "\x9b". Line feeds and tabs stay.
[[nodiscard]] std::string with_controls_escaped(std::string_view text);

// Returns the text with line feeds as "\u000a", which a path may contain.
[[nodiscard]] std::string as_one_line(std::string_view text);

}  // namespace moiregauge::internal
