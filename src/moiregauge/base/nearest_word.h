// SPDX-License-Identifier: Apache-2.0
// Finds the known word nearest to a mistyped one ("did you mean").
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace moiregauge::internal {

// Returns the number of letters to insert, delete or replace (Levenshtein).
[[nodiscard]] inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

// Returns the nearest known word. Returns nothing if more than two letters and more than a third of the letters differ,
// or if the word has more than 64 letters.
[[nodiscard]] inline std::optional<std::string> nearest_word(const std::string& word,
                                                             const std::vector<std::string_view>& known) {
  if (word.size() > 64 || known.empty()) return std::nullopt;
  const auto nearest = *std::min_element(known.begin(), known.end(), [&](std::string_view a, std::string_view b) {
    return edit_distance(word, a) < edit_distance(word, b);
  });
  // A prefix of a known word, e.g. "pitch" for "pitch_mm".
  for (const std::string_view candidate : known) {
    if (candidate.size() > word.size() && word.size() >= 4 && candidate.substr(0, word.size()) == word) {
      return std::string(candidate);
    }
  }
  const std::size_t forgiven = std::max<std::size_t>(2, word.size() / 3);
  return edit_distance(word, nearest) <= forgiven ? std::optional(std::string(nearest)) : std::nullopt;
}

}  // namespace moiregauge::internal
