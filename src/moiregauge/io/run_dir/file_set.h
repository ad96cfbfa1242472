// SPDX-License-Identifier: Apache-2.0
// Writes a folder of files as a whole or not at all.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/base/output_error.h"

namespace moiregauge::internal {

using NamedBytes = std::pair<std::string, std::string>;  // name in the folder, content

enum class Existing {
  kRefuse,   // the folder must be new or empty
  kReplace,  // a folder that holds only files with the extensions of the new ones is replaced
};

// Writes the files to a temporary folder next to DIR, syncs it, and renames it in one step.
// Fails (usage) if DIR may not be replaced. Fails (not usage) if it cannot be written, and leaves nothing behind.
[[nodiscard]] tl::expected<void, OutputError> write_file_set(const std::string& dir,
                                                             const std::vector<NamedBytes>& files, Existing existing);

}  // namespace moiregauge::internal
