// SPDX-License-Identifier: Apache-2.0
// The part of Markdown that the pages of docs/cli are written in: headings, paragraphs, lists, tables, code, links.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace moiregauge::internal::cli {

enum class BlockKind { kHeading, kParagraph, kItem, kCode, kTable };

struct Block {
  BlockKind kind = BlockKind::kParagraph;
  int level = 0;                               // of a heading, 1 the highest
  std::string bullet;                          // of an item: "-", "1."
  std::string text;                            // with its inline marks, on one line; of kCode: the lines as they stand
  std::vector<std::vector<std::string>> rows;  // of a table; the first is its head
};

[[nodiscard]] std::vector<Block> blocks_of(std::string_view markdown);

enum class SpanKind { kPlain, kCode, kStrong, kLink };

struct Span {
  SpanKind kind = SpanKind::kPlain;
  std::string text;
  std::string target;  // of a link
};

// What is open at the end of the text is taken as written.
[[nodiscard]] std::vector<Span> spans_of(std::string_view text);

// The options a page tells of: every code span that begins with a dash, in the first column of tables headed "option".
[[nodiscard]] std::vector<std::string> options_told(std::string_view markdown);

}  // namespace moiregauge::internal::cli
