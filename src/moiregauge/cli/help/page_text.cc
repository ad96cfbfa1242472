// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include "moiregauge/cli/help/markdown.h"
#include "moiregauge/cli/help/page.h"

namespace moiregauge::internal::cli {
namespace {

constexpr std::size_t kIndent = 2;
constexpr std::size_t kHang = 8;        // columns: indentation of an option's description
constexpr std::size_t kShortTerm = 12;  // columns: a table of shorter terms has two columns

// Returns the number of columns of a UTF-8 text. The pages use only characters of one column.
std::size_t columns(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

// Returns the text without marks. Targets of links outside these pages are appended.
std::string plain(std::string_view marked) {
  std::string text;
  for (const Span& span : spans_of(marked)) {
    text += span.kind == SpanKind::kLink ? plain(span.text) : span.text;
    if (span.kind != SpanKind::kLink) continue;
    const std::string target = span.target.substr(0, span.target.find('#'));
    if (target.starts_with("../")) text += fmt::format(" (docs/{})", target.substr(3));
    if (target.starts_with("http")) text += fmt::format(" ({})", target);
  }
  return text;
}

// Breaks words into lines. `first` is the start of the first line.
std::string filled(std::string_view words, std::size_t width, std::size_t indent, std::string first) {
  std::string text, line = std::move(first);
  bool is_empty = true;
  while (!words.empty()) {
    const auto end = std::min(words.find(' '), words.size());
    const std::string_view word = words.substr(0, end);
    words.remove_prefix(std::min(end + 1, words.size()));
    if (word.empty()) continue;
    if (!is_empty && columns(line) + 1 + columns(word) > width) {
      text += line + "\n";
      line.assign(indent, ' ');
      is_empty = true;
    }
    line += (is_empty ? "" : " ") + std::string(word);
    is_empty = false;
  }
  return text + line + "\n";
}

// Formats a table as terms with descriptions, without its head. A third column follows the second.
std::string table_text(const Block& table, std::size_t width) {
  std::size_t widest = 0;
  for (auto row = table.rows.begin() + 1; row < table.rows.end(); ++row)
    widest = std::max(widest, columns(plain(row->front())));
  const std::size_t hang = widest <= kShortTerm ? kIndent + widest + 2 : kHang;
  std::string text;
  for (auto row = table.rows.begin() + 1; row < table.rows.end(); ++row) {
    std::string said;
    for (std::size_t i = 1; i < row->size(); ++i)
      if (!(*row)[i].empty()) said += (said.empty() ? "" : "; ") + plain((*row)[i]);
    std::string term = std::string(kIndent, ' ') + plain(row->front());
    if (said.empty() || columns(term) + 2 > hang) {  // no room for the description on this line
      text += term + "\n";
      term.clear();
    }
    if (!said.empty()) text += filled(said, width, hang, term + std::string(hang - columns(term), ' '));
  }
  return text;
}

std::string code_text(std::string_view lines) {
  std::string text;
  while (!lines.empty()) {
    const auto end = std::min(lines.find('\n'), lines.size());
    const std::string_view line = lines.substr(0, end);
    if (!line.empty()) text += std::string(kIndent + 2, ' ') + std::string(line);
    text += '\n';
    lines.remove_prefix(std::min(end + 1, lines.size()));
  }
  return text;
}

std::string block_text(const Block& block, std::size_t width) {
  const std::string indent(kIndent, ' ');
  switch (block.kind) {
    case BlockKind::kHeading:
      return plain(block.text) + "\n";
    case BlockKind::kParagraph:
      return filled(plain(block.text), width, kIndent, indent);
    case BlockKind::kItem:
      return filled(plain(block.text), width, kIndent + block.bullet.size() + 1, indent + block.bullet + " ");
    case BlockKind::kCode:
      return code_text(block.text);
    case BlockKind::kTable:
      return table_text(block, width);
  }
  return {};
}

}  // namespace

const Page* page_named(std::string_view name) {
  const auto page = std::find_if(pages().begin(), pages().end(), [&](const Page& p) { return p.name == name; });
  return page == pages().end() ? nullptr : &*page;
}

std::string text_of_markdown(std::string_view markdown, std::size_t width) {
  std::string text;
  const Block* before = nullptr;
  const auto blocks = blocks_of(markdown);
  for (const Block& block : blocks) {
    const bool list_goes_on = before != nullptr && before->kind == BlockKind::kItem && block.kind == BlockKind::kItem;
    const bool after_heading = before != nullptr && before->kind == BlockKind::kHeading && before->level > 1;
    if (before != nullptr && !list_goes_on && !after_heading) text += "\n";
    text += block_text(block, width);
    before = &block;
  }
  return text;
}

std::string page_text(std::string_view name, std::size_t width) {
  const Page* page = page_named(name);
  return page == nullptr ? "" : text_of_markdown(page->markdown, width);
}

}  // namespace moiregauge::internal::cli
