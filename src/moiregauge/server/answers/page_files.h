// SPDX-License-Identifier: Apache-2.0
// The files of the page, embedded from web/dist.
#pragma once

#include <string_view>

namespace moiregauge::internal {

[[nodiscard]] std::string_view serve_page_html();
[[nodiscard]] std::string_view serve_page_script();
[[nodiscard]] std::string_view serve_page_style();

}  // namespace moiregauge::internal
