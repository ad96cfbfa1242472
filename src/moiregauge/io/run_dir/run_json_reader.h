// SPDX-License-Identifier: Apache-2.0
// Reads the input's fingerprint from a run.json.
#pragma once

#include <istream>
#include <string>

namespace moiregauge::internal {

// Returns the fingerprint, or an empty text if the file is no JSON or has none. Never throws.
[[nodiscard]] std::string input_sha256_of_run(std::istream& run_json);

}  // namespace moiregauge::internal
