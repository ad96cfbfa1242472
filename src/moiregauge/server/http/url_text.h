// SPDX-License-Identifier: Apache-2.0
// Text of a URL: percent encoding and query parameters.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace moiregauge::internal {

// Returns true if the bytes are UTF-8 without overlong forms or surrogates.
[[nodiscard]] bool is_utf8(std::string_view text);

enum class PlusSign { kLiteral, kSpace };

// Decodes percent escapes. Fails (nothing): an incomplete escape, a NUL, or a result that is not UTF-8.
[[nodiscard]] std::optional<std::string> percent_decoded(std::string_view text, PlusSign plus);

using Parameters = std::vector<std::pair<std::string, std::string>>;

// Decodes "a=1&b=2". Fails (nothing): a bad escape, a repeated name, or more than 32 parameters.
[[nodiscard]] std::optional<Parameters> query_parameters(std::string_view query);

}  // namespace moiregauge::internal
