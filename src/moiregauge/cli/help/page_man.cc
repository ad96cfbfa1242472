// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "moiregauge/cli/help/markdown.h"
#include "moiregauge/cli/help/page.h"
#include "moiregauge/version.h"

namespace moiregauge::internal::cli {
namespace {

// Escapes text for man. A hyphen must become a minus sign, because man pages show another character for it, which
// cannot be copied to a command line.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out;
}

std::string marked_up(std::string_view marked) {
  std::string text;
  for (const Span& span : spans_of(marked)) {
    const bool is_bold = span.kind == SpanKind::kCode || span.kind == SpanKind::kStrong;
    if (span.kind == SpanKind::kLink) {
      const std::string target = span.target.substr(0, span.target.find('#'));
      text += marked_up(span.text);
      if (target.starts_with("../")) text += escaped(fmt::format(" (docs/{})", target.substr(3)));
      if (target.starts_with("http")) text += escaped(fmt::format(" ({})", target));
      if (target.ends_with(".md") && target.find('/') == std::string::npos)
        text += escaped(fmt::format(" (moiregauge-{}(1))", target.substr(0, target.size() - 3)));
    } else {
      text += is_bold ? fmt::format("\\fB{}\\fR", escaped(span.text)) : escaped(span.text);
    }
  }
  return text;
}

// Ends a line. A dot or apostrophe at its start would be a request of man, and is escaped.
std::string line_of(const std::string& text) {
  const bool is_request = text.starts_with('.') || text.starts_with('\'');
  return (is_request ? "\\&" : "") + text + "\n";
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::string code_lines(std::string_view lines) {
  std::string text;
  while (!lines.empty()) {
    const auto end = std::min(lines.find('\n'), lines.size());
    text += line_of(escaped(lines.substr(0, end)));
    lines.remove_prefix(std::min(end + 1, lines.size()));
  }
  return text;
}

std::string table_man(const Block& table) {
  std::string text;
  for (auto row = table.rows.begin() + 1; row < table.rows.end(); ++row) {
    std::string said;
    for (std::size_t i = 1; i < row->size(); ++i)
      if (!(*row)[i].empty()) said += (said.empty() ? "" : "; ") + marked_up((*row)[i]);
    text += ".TP\n" + line_of(marked_up(row->front())) + line_of(said);
  }
  return text;
}

std::string block_man(const Block& block) {
  switch (block.kind) {
    case BlockKind::kHeading:
      return fmt::format("{} {}\n", block.level <= 2 ? ".SH" : ".SS",
                         block.level <= 2 ? upper(marked_up(block.text)) : marked_up(block.text));
    case BlockKind::kParagraph:
      return ".PP\n" + line_of(marked_up(block.text));
    case BlockKind::kItem:
      return fmt::format(".IP {} 3\n", block.bullet == "-" ? "\\(bu" : block.bullet) + line_of(marked_up(block.text));
    case BlockKind::kCode:
      return ".PP\n.RS 4\n.nf\n" + code_lines(block.text) + ".fi\n.RE\n";
    case BlockKind::kTable:
      return table_man(block);
  }
  return {};
}

}  // namespace

std::string man_of_markdown(std::string_view markdown, std::string_view name, std::string_view summary) {
  const std::string title = name == "moiregauge" ? std::string(name) : fmt::format("moiregauge-{}", name);
  std::string text = fmt::format(".TH {} 1 \"\" \"moiregauge {}\" \"moiregauge\"\n.SH NAME\n{} \\- {}\n", upper(title),
                                 kVersion, escaped(title), escaped(summary));
  bool has_synopsis = false, has_description = false;
  for (const Block& block : blocks_of(markdown)) {
    if (block.kind == BlockKind::kHeading && block.level == 1) continue;  // the NAME section replaces it
    if (block.kind == BlockKind::kCode && !has_synopsis && !has_description) {
      text += ".SH SYNOPSIS\n.nf\n" + code_lines(block.text) + ".fi\n";
      has_synopsis = true;
      continue;
    }
    if (!has_description && block.kind != BlockKind::kHeading) text += ".SH DESCRIPTION\n";
    has_description = true;
    text += block_man(block);
  }
  return text;
}

std::string page_man(std::string_view name, std::string_view summary) {
  const Page* page = page_named(name);
  return page == nullptr ? "" : man_of_markdown(page->markdown, name, summary);
}

}  // namespace moiregauge::internal::cli
