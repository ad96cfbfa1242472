// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>
#include <tl/expected.hpp>

namespace moiregauge::internal {

// Reads the JSON object of a request. Fails with "what: where: what to do": no object, nested over 16 levels, a repeated
// key, bytes that are not UTF-8.
[[nodiscard]] tl::expected<nlohmann::json, std::string> parse_json_body(std::string_view text);

// Returns a JSON answer's text. Bytes that are not UTF-8, as in file names, are replaced, and '<' is escaped.
[[nodiscard]] std::string json_answer_text(const nlohmann::ordered_json& json);

}  // namespace moiregauge::internal
