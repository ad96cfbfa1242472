// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace moiregauge::internal {

// Returns a time as stated in a file as UTC, "2026-05-04T09:12:33.25Z". `iso` is ISO 8601 with a date, a time and an
// offset: "2026-05-04T11:12:33.250+02:00", "2026-05-04 09:12:33Z".
// Empty: it is no such text, or it has no offset, so that its zone is unknown.
[[nodiscard]] std::string utc_text(std::string_view iso);

}  // namespace moiregauge::internal
