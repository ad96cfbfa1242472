// SPDX-License-Identifier: Apache-2.0
// Parses the subset of Markdown used in docs/cli: headings, paragraphs, lists, tables, code and links.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace moiregauge::internal::cli {

enum class BlockKind { kHeading, kParagraph, kItem, kCode, kTable };

struct Block {
  BlockKind kind = BlockKind::kParagraph;
  int level = 0;                               // for a heading; 1 is the highest
  std::string bullet;                          // for an item: "-", "1."
  std::string text;                            // with inline marks, on one line; kCode: unchanged lines
  std::vector<std::vector<std::string>> rows;  // for a table; the first is its header
};

[[nodiscard]] std::vector<Block> blocks_of(std::string_view markdown);

enum class SpanKind { kPlain, kCode, kStrong, kLink };

struct Span {
  SpanKind kind = SpanKind::kPlain;
  std::string text;
  std::string target;  // for a link
};

// Splits text into spans. A mark that is not closed is plain text.
[[nodiscard]] std::vector<Span> spans_of(std::string_view text);

// Returns the options described by a page: code spans starting with a dash, in the first column of tables headed
// "option".
[[nodiscard]] std::vector<std::string> documented_options(std::string_view markdown);

}  // namespace moiregauge::internal::cli
