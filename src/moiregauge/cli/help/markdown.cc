// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/help/markdown.h"

#include <algorithm>
#include <cctype>
#include <utility>

namespace moiregauge::internal::cli {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto is_space = [](char c) { return c == ' ' || c == '\r'; };
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

std::vector<std::string> cells_of(std::string_view row) {
  row = trimmed(row);
  if (row.starts_with('|')) row.remove_prefix(1);
  if (row.ends_with('|') && !row.ends_with("\\|")) row.remove_suffix(1);
  std::vector<std::string> cells(1);
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (row[i] == '\\' && i + 1 < row.size() && row[i + 1] == '|')
      cells.back() += row[++i];
    else if (row[i] == '|')
      cells.emplace_back();
    else
      cells.back() += row[i];
  }
  for (std::string& cell : cells) cell = std::string(trimmed(cell));
  return cells;
}

bool is_rule(std::string_view row) { return row.find_first_not_of("|-: \r") == std::string_view::npos; }

// Returns "-" or "1." if the line starts an item, otherwise nothing.
std::string_view bullet_of(std::string_view line) {
  if (line.starts_with("- ")) return line.substr(0, 1);
  std::size_t digits = 0;
  while (digits < line.size() && std::isdigit(static_cast<unsigned char>(line[digits])) != 0) ++digits;
  return digits > 0 && line.substr(digits).starts_with(". ") ? line.substr(0, digits + 1) : std::string_view{};
}

class Reader {
 public:
  void take(std::string_view line) {
    if (in_fence_) return take_fenced(line);
    const std::string_view bare = trimmed(line);
    if (bare.starts_with("```")) {
      in_fence_ = true;
      blocks_.push_back({BlockKind::kCode, 0, {}, {}, {}});
    } else if (bare.empty()) {
      after_gap_ = true;
      return;
    } else if (line.starts_with("    ") && (after_gap_ || is_last(BlockKind::kCode))) {
      take_code(line.substr(4));
    } else if (line.starts_with('#')) {
      const std::size_t level = line.find_first_not_of('#');
      blocks_.push_back(
          {BlockKind::kHeading, static_cast<int>(level), {}, std::string(trimmed(line.substr(level))), {}});
    } else if (bare.starts_with('|')) {
      take_row(bare);
    } else if (const auto bullet = bullet_of(bare); !bullet.empty()) {
      blocks_.push_back(
          {BlockKind::kItem, 0, std::string(bullet), std::string(trimmed(bare.substr(bullet.size()))), {}});
    } else {
      take_words(line, bare);
    }
    after_gap_ = false;
  }
  std::vector<Block> blocks() && { return std::move(blocks_); }

 private:
  [[nodiscard]] bool is_last(BlockKind kind) const { return !blocks_.empty() && blocks_.back().kind == kind; }

  void take_fenced(std::string_view line) {
    if (trimmed(line).starts_with("```"))
      in_fence_ = false;
    else
      blocks_.back().text += std::string(line) + "\n";
    after_gap_ = !in_fence_;
  }

  void take_code(std::string_view line) {
    if (!is_last(BlockKind::kCode))
      blocks_.push_back({BlockKind::kCode, 0, {}, {}, {}});
    else if (after_gap_)
      blocks_.back().text += "\n";
    blocks_.back().text += std::string(line) + "\n";
  }

  void take_row(std::string_view row) {
    if (!is_last(BlockKind::kTable) || after_gap_) blocks_.push_back({BlockKind::kTable, 0, {}, {}, {}});
    if (!is_rule(row)) blocks_.back().rows.push_back(cells_of(row));
  }

  // Appends the line to the previous paragraph or item, unless an empty line separates them.
  void take_words(std::string_view line, std::string_view bare) {
    const bool goes_on = is_last(BlockKind::kParagraph) || (is_last(BlockKind::kItem) && line.starts_with(' '));
    if (goes_on && !after_gap_)
      blocks_.back().text += " " + std::string(bare);
    else
      blocks_.push_back({BlockKind::kParagraph, 0, {}, std::string(bare), {}});
  }

  std::vector<Block> blocks_;
  bool in_fence_ = false;
  bool after_gap_ = true;
};

}  // namespace

std::vector<Block> blocks_of(std::string_view markdown) {
  Reader reader;
  while (!markdown.empty()) {
    const auto end = std::min(markdown.find('\n'), markdown.size());
    reader.take(markdown.substr(0, end));
    markdown.remove_prefix(std::min(end + 1, markdown.size()));
  }
  return std::move(reader).blocks();
}

std::vector<Span> spans_of(std::string_view text) {
  std::vector<Span> spans(1);
  const auto put = [&](SpanKind kind, std::string_view words, std::string_view target) {
    spans.push_back({kind, std::string(words), std::string(target)});
    spans.emplace_back();
  };
  std::size_t at = 0;
  const auto marked = [&](SpanKind kind, std::string_view mark) {
    const auto end = text.substr(at).starts_with(mark) ? text.find(mark, at + mark.size()) : std::string_view::npos;
    if (end == std::string_view::npos) return false;
    put(kind, text.substr(at + mark.size(), end - at - mark.size()), {});
    at = end + mark.size();
    return true;
  };
  while (at < text.size()) {
    if (marked(SpanKind::kCode, "`") || marked(SpanKind::kStrong, "**")) continue;
    const auto middle = text[at] == '[' ? text.find("](", at) : std::string_view::npos;
    const auto end = middle == std::string_view::npos ? middle : text.find(')', middle);
    if (end != std::string_view::npos) {
      put(SpanKind::kLink, text.substr(at + 1, middle - at - 1), text.substr(middle + 2, end - middle - 2));
      at = end + 1;
    } else {
      spans.back().text += text[at++];
    }
  }
  std::erase_if(spans, [](const Span& span) { return span.text.empty(); });
  return spans;
}

std::vector<std::string> documented_options(std::string_view markdown) {
  std::vector<std::string> options;
  for (const Block& block : blocks_of(markdown)) {
    if (block.kind != BlockKind::kTable || block.rows.empty() || block.rows.front().front() != "option") continue;
    for (const auto& row : block.rows) {
      for (const Span& span : spans_of(row.front())) {
        if (span.kind == SpanKind::kCode && span.text.starts_with('-'))
          options.push_back(span.text.substr(0, span.text.find(' ')));
      }
    }
  }
  return options;
}

}  // namespace moiregauge::internal::cli
