// SPDX-License-Identifier: Apache-2.0
// run.mgj: what the frames told, kept so that a run can be solved again without them (docs/file-formats.md).
#pragma once

#include <cstdint>
#include <functional>
#include <istream>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "moiregauge/run/measure.h"

namespace moiregauge {

// Raised when a stored field changes its meaning; a field more or less is noticed without it.
inline constexpr std::uint32_t kRunFileVersion = 1;
inline constexpr std::string_view kRunFileName = "run.mgj";

struct StoredRun {
  MeasureOptions options;
  Seen seen;
};

// Hands the file's bytes on piece by piece; `put` returns false to stop.
using PutBytes = std::function<bool(std::string_view)>;
bool write_run(const Seen& seen, const MeasureOptions& options, const PutBytes& put);

// All of it, or "what: where: what to do". Every byte is checked; nothing is believed of a file that is not whole.
[[nodiscard]] tl::expected<StoredRun, std::string> read_run(const std::string& path);
[[nodiscard]] tl::expected<StoredRun, std::string> parse_run(std::istream& file, const std::string& path);

}  // namespace moiregauge
