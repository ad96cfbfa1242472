// SPDX-License-Identifier: Apache-2.0
// The data elements of report.html: script elements with an id, between the parts of the bundled page.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "moiregauge/displacement/sample.h"

namespace moiregauge::internal {

struct PageScript {
  std::string id;
  std::string type;     // "application/json" or "text/plain"
  std::string content;  // JSON texts are escaped by for_script
};

// Escapes '<', so that no text of a run can close its script element or open a comment.
[[nodiscard]] std::string for_script(std::string_view json);

// Returns the bundled page with title and scripts in place of its marks. Empty if the template has no marks.
[[nodiscard]] std::string assembled_page(const std::string& title, const std::vector<PageScript>& scripts);

// Returns the page with another script of this id, in the current template. All other data stay the same.
// Returns nothing if `page` is not a report.
[[nodiscard]] std::optional<std::string> page_with(std::string_view page, const PageScript& script);

// Returns the number of a status in the columns of the page.
[[nodiscard]] double status_code(Status status);
// Returns all statuses in the order of their numbers.
[[nodiscard]] const std::vector<Status>& page_statuses();

}  // namespace moiregauge::internal
