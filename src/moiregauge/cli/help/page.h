// SPDX-License-Identifier: Apache-2.0
// The pages of docs/cli, which the program carries with it, as text for a terminal and as man pages.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace moiregauge::internal::cli {

struct Page {
  std::string_view name;  // of the command; "moiregauge" is the page of the program as a whole
  std::string_view markdown;
};

// All of docs/cli at the time of the build (cmake/EmbedPages.cmake), by name.
[[nodiscard]] std::span<const Page> pages();

// nullptr: no such page.
[[nodiscard]] const Page* page_named(std::string_view name);

// For a terminal; `width` in columns. Empty when there is no such page.
[[nodiscard]] std::string page_text(std::string_view name, std::size_t width = 100);

// In man's own language, section 1; `summary` stands behind the name. Empty when there is no such page.
[[nodiscard]] std::string page_man(std::string_view name, std::string_view summary);

// The same of Markdown that is at hand.
[[nodiscard]] std::string text_of_markdown(std::string_view markdown, std::size_t width);
[[nodiscard]] std::string man_of_markdown(std::string_view markdown, std::string_view name, std::string_view summary);

}  // namespace moiregauge::internal::cli
