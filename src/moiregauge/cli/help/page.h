// SPDX-License-Identifier: Apache-2.0
// Shows the pages of docs/cli, which are embedded in the program, in a terminal or as man pages.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace moiregauge::internal::cli {

struct Page {
  std::string_view name;  // command name; "moiregauge": the page of the program
  std::string_view markdown;
};

// Returns all pages of docs/cli as of the build (cmake/EmbedPages.cmake), in the order of their names.
[[nodiscard]] std::span<const Page> pages();

// Returns a page, or nullptr if there is none.
[[nodiscard]] const Page* page_named(std::string_view name);

// Returns a page for the terminal, at most `width` columns wide. Empty if there is no such page.
[[nodiscard]] std::string page_text(std::string_view name, std::size_t width = 100);

// Returns a man page of section 1. `summary` follows the name. Empty if there is no such page.
[[nodiscard]] std::string page_man(std::string_view name, std::string_view summary);

// Return the same for Markdown text.
[[nodiscard]] std::string text_of_markdown(std::string_view markdown, std::size_t width);
[[nodiscard]] std::string man_of_markdown(std::string_view markdown, std::string_view name, std::string_view summary);

}  // namespace moiregauge::internal::cli
