// SPDX-License-Identifier: Apache-2.0
// All text for a terminal goes through here: control characters are escaped, and output that is lost is noticed.
#pragma once

#include <string_view>

namespace moiregauge::internal::cli {

// Writes to stdout. A failure is reported by finish_output at the end.
void print_out(std::string_view text);

// Writes a file's bytes to stdout as they are.
void put_bytes(std::string_view bytes);

// Writes to stderr. There is no place to report a failure, so it is ignored.
void print_note(std::string_view text);

// Flushes stdout. Returns false if output was lost; errno is the reason.
[[nodiscard]] bool finish_output();

}  // namespace moiregauge::internal::cli
