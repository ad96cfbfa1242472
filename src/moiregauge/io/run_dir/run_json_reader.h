// SPDX-License-Identifier: Apache-2.0
// What is read back of a run.json: which input it was made from.
#pragma once

#include <istream>
#include <string>

namespace moiregauge::internal {

// The input's fingerprint; empty when the file is no JSON or does not say. Never throws, whatever the file holds.
[[nodiscard]] std::string input_sha256_of_run(std::istream& run_json);

}  // namespace moiregauge::internal
