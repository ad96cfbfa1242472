// SPDX-License-Identifier: Apache-2.0
// index.html of a batch: every clip with its outcome, values and a small plot. One file that loads no other.
#pragma once

#include <string>
#include <string_view>

#include "moiregauge/batch/collected_clip.h"

namespace moiregauge::internal {

// The page up to its list of clips, and behind it. Between them are the texts of page_entry, separated by commas.
struct PageParts {
  std::string_view before, after;
};
[[nodiscard]] PageParts page_parts();

// Returns a clip as JSON that is valid inside a script element. The page shows all texts as text, never as HTML.
[[nodiscard]] std::string page_entry(const CollectedClip& clip);

// The bytes of index_page.html.
[[nodiscard]] std::string_view index_page_template();

}  // namespace moiregauge::internal
